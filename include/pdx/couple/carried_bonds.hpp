#pragma once
#include "pdx/couple/carried_family.hpp"
#include "pdx/field/row_shift.hpp"

namespace pdx::couple {
/// The bonds that do not join two particles of a patch: springs of the coupling schemes, all with the bond force law.
/// They are held in families, one for each patch, which a change of layout hands on as they are where a patch and what
/// is around it stay.
template <int Dim> class CarriedBonds final : public field::Term {
public:
  using Family = CarriedFamily<Dim>;
  using Families = std::vector<std::unique_ptr<Family>>;
  /// Of one family, whatever patches it is of.
  CarriedBonds(const field::Rows& rows, CarriedPoints<Dim> points, std::vector<CarriedBond<Dim>> bonds,
               law::Kinematics kinematics, bool symmetric);
  /// @param families one per patch; those that have been bound before are of the layout before
  /// @param shift from that layout; null where none has been
  CarriedBonds(const field::Rows& rows, Families families, std::shared_ptr<const field::RowShift> shift,
               law::Kinematics kinematics, bool symmetric);
  /// The families leave this Term, of which nothing may be asked any more.
  Families give_up() { return std::move(families_); }
  /// Between two layouts `energy` leaves out families that stay, as pd::BondTerm does.
  void leave_out(std::vector<bool> families) { left_out_ = std::move(families); }

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  /// From now on `add_residual` is for explicit steps: bonds along straight sides in runs. After `bind`.
  void step_explicitly();
  /// A bond's free strain is the mean of those at its ends; then forces go bond by bond. Not after `step_explicitly`.
  void swell(const field::FreeStrain& strain) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override;
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  bool constant_jacobian() const override { return kinematics_ == law::Kinematics::small; }
  bool symmetric() const override { return symmetric_; }
  /// Of intact bonds, with d = sum_k c_k y_k at their ends a and b: (n.(d_a - d_b))^2 <= 2 (n.d_a)^2 + 2 (n.d_b)^2 and
  /// (n.d)^2 <= (sum_k |c_k|) sum_k |c_k| (n.y_k)^2. Throws std::logic_error if the tangent is not symmetric: there is
  /// no such bound.
  void add_stiffness_bound(std::span<double> blocks) const override;

  /// What particles hand to the points where their bonds leave the patch. After `bind`.
  void add_mass(std::span<double> mass) const override;

  /// Adds half of each whole bond's energy to the density of the particle at its first end [J/m^3], one entry per row.
  void add_energy_density(std::span<const double> u, std::span<double> density) const;

  /// Breaks all bonds with s > s0 at displacement u (local blocks [owned | halo]). Ranks that hold the same bond judge
  /// it alike. @param rules one per patch   @return what this rank counts, as in `energy`
  /// @param losses if not null, the forces of the broken bonds on owned rows are appended
  pd::Broken break_bonds(std::span<const double> u, std::span<const pd::BreakRule> rules,
                         field::ForceLosses* losses = nullptr);
  /// From now on `add_residual` looks for bonds that these rules would break at its displacement.
  void watch(std::span<const pd::BreakRule> rules);
  bool overstretched_seen() const; ///< by the last `add_residual`, on this rank
  /// Appends s/s0 of the bonds that `break_bonds` would break and this rank counts.
  void overstretched(std::span<const double> u, std::span<const pd::BreakRule> rules,
                     std::vector<double>& ratios) const;
  /// Keys of the bonds that broke and this rank counts.
  std::vector<std::uint64_t> broken() const;
  /// Calls visit(key, patch) for each bond of this rank that is new in this layout: others know what broke.
  template <class Visit> void for_each_new_key(Visit&& visit) const
  {
    for (std::size_t f = 0; f < families_.size(); ++f)
      if (!kept_[f]) families_[f]->for_each_key(visit);
  }
  /// Breaks the bonds with these keys, where they are new in this layout. @param keys ascending, of all ranks
  void set_broken(std::span<const std::uint64_t> keys);
  /// Remembers which bonds are gone; `restore` goes back to what was remembered last.
  void save();
  void restore();
  std::int64_t revision() const override;
  /// Adds the volume at the outer ends to the particles' families, one entry per owned row.
  void add_bonded_volume(std::span<pd::BondedVolume> volumes) const;
  /// Local rows of the particles that lost such bonds to load are appended.
  void add_thinned(std::vector<Index>& rows) const;
  void add_bonded_volume(Index row, pd::BondedVolume& volume) const; ///< the same for one particle

  /// Appends pairs of local rows that the intact bonds hold together, in tied displacements. After `bind`.
  void add_joints(std::vector<std::array<Index, 2>>& pairs) const;

  std::size_t size() const;
  std::int64_t bonds() const; ///< intact ones that this rank counts; after `bind`

private:
  field::Rows rows_;
  Families families_;
  std::vector<bool> kept_, left_out_; // per family: of the layout before; empty: none
  std::shared_ptr<const field::RowShift> shift_;
  law::Kinematics kinematics_;
  bool symmetric_;
};
} // namespace pdx::couple
