#pragma once
#include "pdx/field/term.hpp"
#include "pdx/pd/csr_part.hpp"
#include "pdx/pd/damage.hpp"

#include <limits>

namespace pdx::pd {
/// The bonds of particles that lie anywhere, for explicit steps: their rows are all the rows there are. Forces are to
/// the last bit the same on any number of ranks.
template <int Dim> class CloudTerm final : public field::Term {
public:
  /// @param cloud the whole cloud, alike on every rank; not kept
  /// @param mine numbers in the cloud of the particles of this rank's rows, ascending
  /// Throws UserError, alike on every rank, for what CsrPart refuses and a horizon without neighbours. Collective.
  CloudTerm(const field::Rows& rows, const Cloud<Dim>& cloud, std::span<const Index> mine, const CloudOptions& options,
            Kinematics kinematics);

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void couplings(field::Couplings& couplings, bool whole) const override; ///< throws: there is no tangent
  void add_jacobian(field::BlockAdder& adder, bool whole) const override; ///< throws: there is no tangent
  void add_mass(std::span<double> mass) const override;
  /// As BondTerm's.
  void add_stiffness_bound(std::span<double> blocks) const override;

  /// Takes out the bonds that a crack parts, the precrack, and returns how many of them this rank counts.
  std::int64_t cut(const crack::CrackSet& cracks);
  /// From now on forces look out for bonds with a larger stretch than this; none with an end in a box [m] breaks.
  void watch(double critical_stretch, std::span<const geom::Box<2>> no_fail);
  /// True if the last `add_residual` saw a bond of this rank that may be overstretched.
  bool overstretched_seen() const { return seen_; }
  /// Breaks what is overstretched at u, the displacement of the last force; returns what this rank counts. Ranks judge
  /// shared bonds by the same arithmetic, and nothing travels.
  /// @param losses the forces of the broken bonds on owned rows are appended
  Broken break_overstretched(std::span<const double> u, field::ForceLosses& losses);
  void save() { saved_.assign(part_.intact().begin(), part_.intact().end()); }
  void restore() { part_.restore(saved_); } ///< needs a `save` before

  int words_per_particle() const { return words_; } ///< the same on every rank
  /// Which bonds of the owned particles are gone, cut ones included: one bit each, in the order of the cloud.
  std::vector<std::uint64_t> gone() const;
  /// Breaks the bonds that these words have.
  void set_gone(std::span<const std::uint64_t> words);
  std::vector<BondedVolume> bonded_volume() const;                                   ///< of the owned particles
  std::span<const double> volumes() const { return part_.volumes().first(owned()); } ///< of the owned particles [m^3]
  const CsrPart<Dim>& part() const { return part_; }

private:
  std::size_t owned() const { return static_cast<std::size_t>(rows_.owned()); }

  field::Rows rows_;
  Kinematics kinematics_;
  double density_;                  // [kg/m^3]
  std::vector<PetscInt> halo_rows_; // ascending: the halo of CsrPart is that of the rows
  CsrPart<Dim> part_;
  int words_ = 1;
  std::vector<double> whole_, start_; // bonded volume before and after `cut` [m^3]
  double critical_stretch_ = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> no_fail_, saved_;
  mutable bool seen_ = false;
};
} // namespace pdx::pd
