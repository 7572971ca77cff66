#pragma once
#include "pdx/field/term.hpp"
#include "pdx/pd/strip_part.hpp"

#include <memory>

namespace pdx::pd {
/// The bonds between the particles of all patches. Matrix-free except for the diagonal blocks, or assembled in full
/// as reference (`-pd_operator assembled`), or in lane strips for explicit steps.
template <int Dim> class BondTerm final : public field::Term {
public:
  BondTerm(std::vector<std::unique_ptr<LatticePart<Dim>>> parts, Kinematics kinematics, bool assembled);
  /// What of a part lies here, and may go on with it in another Term.
  struct Laid {
    std::unique_ptr<StripPart<Dim>> strip; ///< null: the part is new
    typename LatticePart<Dim>::Window scratch;
  };
  struct Parts {
    std::vector<std::unique_ptr<LatticePart<Dim>>> parts;
    std::vector<Laid> laid; ///< of each
  };
  /// Of parts that another Term of the same kind gave up; those that are laid keep bonds that broke and what protects
  /// them.
  BondTerm(Parts parts, Kinematics kinematics);
  /// Parts that step explicitly leave this Term, of which nothing may be asked any more.
  Parts give_up();
  bool is_kept(std::size_t part) const { return part < kept_.size() && kept_[part]; } ///< laid before
  /// Between two layouts `energy` leaves out parts that stay: no part, until it is told some. Parts that are kept are
  /// left out at first. @param parts one for each; empty: none is left out
  void leave_out(std::vector<bool> parts) { left_out_ = std::move(parts); }

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double waited() const override;
  /// In forces worked out for explicit steps there is no free strain.
  void swell(const field::FreeStrain& strain) override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override;
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  void add_tangent_action(std::span<const double> x, std::span<double> y) const override;
  void weak_rows(std::vector<Index>& rows) const override;
  bool constant_jacobian() const override { return kinematics_ == Kinematics::small; }
  void add_mass(std::span<double> mass) const override;
  void add_mass_in(field::RowRanges wanted, std::span<double> mass) const override;
  /// D_i = 2 sum_j w K_ij of the intact bonds: (n.(u_i - u_j))^2 <= 2 (n.u_i)^2 + 2 (n.u_j)^2. Nothing of parts that
  /// are kept, whose bounds are known.
  void add_stiffness_bound(std::span<double> blocks) const override;

  /// Takes out the bonds that a crack parts, the precrack, and returns how many of them this rank counts.
  std::int64_t cut(const crack::CrackSet& cracks);
  /// No bond with an end in one of the boxes [m] breaks.
  void protect(std::span<const geom::Box<2>> boxes);
  using Windows = std::vector<typename LatticePart<Dim>::Window>;
  /// Displacement of all particles of the patches, halo included; good until the next call of anything else here.
  /// Collective.
  const Windows& load(std::span<const double> u) const;
  /// Breaks what is overstretched there. @param rules one per patch   @return what this rank counts
  Broken break_bonds(const Windows& loaded, std::span<const BreakRule> rules);
  /// s/s0 of the bonds that `break_bonds` would break and this rank counts, in any order.
  void overstretched(const Windows& loaded, std::span<const BreakRule> rules, std::vector<double>& ratios) const;

  /// From now on forces and energies are worked out for explicit steps, in lane strips, and bonds are watched while
  /// forces are added up. Collective.
  /// @param rules one per patch; none: nothing breaks   @param processor the version to run in
  void step_explicitly(std::span<const BreakRule> rules, Processor processor = chosen_processor());
  /// As StripPart::skip_below, for all patches [m].
  void skip_below(double displacement);
  /// True if the last `add_residual` or `energy` saw a bond of this rank that may be overstretched.
  bool overstretched_seen() const;
  /// Breaks what is overstretched at the displacement of the last `add_residual` or `energy`; returns what this rank
  /// counts. Only tiles where they saw something are looked at, and no rank waits for another.
  /// @param losses the forces of the broken bonds on owned rows are appended
  Broken break_overstretched(field::ForceLosses* losses = nullptr);
  /// Tiles of bonds that passes in lane strips computed, and those they skipped because they were at rest; this rank.
  std::int64_t tiles_computed() const;
  std::int64_t tiles_skipped() const;

  std::int64_t revision() const override { return revision_; }
  /// Breaks bonds of a part, named as `LatticePart::set_gone` takes them.
  template <class Bonds> void set_gone(std::size_t part, const Bonds& bonds)
  {
    ++revision_;
    parts_[part]->set_gone(std::span(bonds));
    if (!strips_.empty()) strips_[part]->take_over_words();
  }
  void save();
  void restore();             ///< needs a `save` before
  std::int64_t bonds() const; ///< intact ones that this rank counts
  /// Adds to one entry per owned row; carried bonds add theirs.
  void add_bonded_volume(std::span<BondedVolume> volumes) const;

  const std::vector<std::unique_ptr<LatticePart<Dim>>>& parts() const { return parts_; }
  /// Strain energy density of the owned particles by their lattice bonds [J/m^3]; carried bonds add theirs.
  std::vector<double> energy_density(std::span<const double> u) const;

private:
  void take_over_words(bool all);
  void add_diagonal(field::BlockAdder& adder) const;
  void add_whole(field::BlockAdder& adder, const LatticePart<Dim>& part, std::size_t number) const;

  std::vector<std::unique_ptr<LatticePart<Dim>>> parts_;
  std::vector<bool> kept_, left_out_; // per part; empty: none
  Kinematics kinematics_;
  bool assembled_;
  std::int64_t revision_ = 0; // of the bonds
  const field::RowHalo* halo_ = nullptr;
  Windows state_; // displacement the tangent is taken at
  mutable Windows scratch_;
  std::vector<std::unique_ptr<StripPart<Dim>>> strips_; // of all parts, or none
  double at_rest_ = 0.0;                                // see skip_below [m]
};
} // namespace pdx::pd
