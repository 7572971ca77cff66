#pragma once
#include "pdx/couple/carried_kernel.hpp"
#include "pdx/couple/carried_points.hpp"
#include "pdx/couple/leaving.hpp"
#include "pdx/field/force_loss.hpp"
#include "pdx/field/term.hpp"
#include "pdx/law/bond_force.hpp"
#include "pdx/pd/breaker.hpp"
#include "pdx/pd/damage.hpp"

#include <memory>

namespace pdx::couple {
template <int Dim> class CarriedRuns;

/// A bond between two carried points. Its force may act at other points than those that stretch it (the `interface`
/// scheme); then the tangent is not symmetric.
template <int Dim> struct CarriedBond {
  Index a = 0, b = 0;             ///< points whose displacements stretch the bond
  Index force_a = 0, force_b = 0; ///< points its force acts at
  Vector<Dim> xi;                 ///< reference vector from a to b                       [m]
  double kappa = 0.0;             ///< force per unit stretch                             [N]
  double energy_share = 0.0;      ///< whole bond length over particle volume where a is a particle, else 0 [1/m^2]
  double volume = 0.0;            ///< beta V of the outer end where a is a particle, else 0 [m^3]
  double handed = 0.0;            ///< mass that the particle at `a` hands to what carries b [kg]
  bool cut = false;               ///< by a crack from the start: it carries nothing, but counts in the whole family
  bool no_fail = false;           ///< it never breaks
  double stretch = 1.0;           ///< its critical stretch over that of the patch           [-]
  Index patch = 0;                ///< the patch of its particle, whose critical stretch it has
  std::uint64_t key = 0;          ///< the bond's own number, the same on any rank and any number of ranks
  Leaving leaves = {};            ///< through which straight side of the patch, where that is known
  Vector<2> from = {0.0, 0.0};    ///< where a is, in the plane                           [m]
};

/// The carried bonds of one patch, or of several: what `CarriedBonds` has of them, which says what is asked for here.
/// Those that are cut or broken stay in `couplings`, so that a matrix keeps its pattern, and nowhere else.
template <int Dim> class CarriedFamily {
public:
  CarriedFamily(const field::Rows& rows, CarriedPoints<Dim> points, std::vector<CarriedBond<Dim>> bonds,
                law::Kinematics kinematics, bool symmetric);
  ~CarriedFamily();
  CarriedFamily(const CarriedFamily&) = delete;
  CarriedFamily& operator=(const CarriedFamily&) = delete;

  void needed_rows(std::vector<PetscInt>& rows) const;
  void bind(const field::RowHalo& halo);
  bool bound() const { return bound_; }
  /// Local rows that carry its points, each once, ascending; after `bind`.
  const std::vector<Index>& used_rows() const { return used_; }
  /// The rows are others from now on, where a patch and its surroundings stay what they were. After `bind`.
  /// @param now per local row before: local row now; empty: they stay what they were   @param patch number of the patch
  /// from now on
  void move_rows(const field::Rows& rows, std::span<const Index> now, Index patch);
  /// From now on `add_residual` is for explicit steps: bonds along straight sides in runs. After `bind`.
  void step_explicitly();
  /// A bond's free strain is the mean of those at its ends; then forces go bond by bond. Not after `step_explicitly`.
  void swell(const field::FreeStrain& strain);
  void add_residual(std::span<const double> u, std::span<double> r) const;
  double energy(std::span<const double> u) const;
  void linearise(std::span<const double> u);
  void couplings(field::Couplings& couplings, bool whole) const;
  void add_jacobian(field::BlockAdder& adder, bool whole) const;
  /// Of intact bonds, with d = sum_k c_k y_k at their ends a and b: (n.(d_a - d_b))^2 <= 2 (n.d_a)^2 + 2 (n.d_b)^2 and
  /// (n.d)^2 <= (sum_k |c_k|) sum_k |c_k| (n.y_k)^2. Throws std::logic_error if the tangent is not symmetric: there is
  /// no such bound.
  void add_stiffness_bound(std::span<double> blocks) const;

  /// What particles hand to the points where their bonds leave the patch. After `bind`.
  void add_mass(std::span<double> mass) const;

  /// Adds half of each whole bond's energy to the density of the particle at its first end [J/m^3], one entry per row.
  void add_energy_density(std::span<const double> u, std::span<double> density) const;

  /// Breaks all bonds with s > s0 at displacement u (local blocks [owned | halo]). Ranks that hold the same bond judge
  /// it alike. @param rules one per patch   @return what this rank counts, as in `energy`
  /// @param losses if not null, the forces of the broken bonds on owned rows are appended
  pd::Broken break_bonds(std::span<const double> u, std::span<const pd::BreakRule> rules,
                         field::ForceLosses* losses = nullptr);
  /// From now on `add_residual` looks for bonds that these rules would break at its displacement.
  void watch(std::span<const pd::BreakRule> rules);
  bool overstretched_seen() const { return overstretched_seen_; } ///< by the last `add_residual`, on this rank
  /// Appends s/s0 of the bonds that `break_bonds` would break and this rank counts.
  void overstretched(std::span<const double> u, std::span<const pd::BreakRule> rules,
                     std::vector<double>& ratios) const;
  /// Keys of the bonds that broke and this rank counts.
  std::vector<std::uint64_t> broken() const;
  /// Calls visit(key, patch) for each bond of this rank.
  template <class Visit> void for_each_key(Visit&& visit) const
  {
    for (const CarriedBond<Dim>& bond : bonds_) visit(bond.key, bond.patch);
  }
  /// Breaks the bonds with these keys. @param keys ascending, of all ranks
  void set_broken(std::span<const std::uint64_t> keys);
  /// Remembers which bonds are gone; `restore` goes back to what was remembered last.
  void save() { saved_ = gone_; }
  void restore()
  {
    revision_ += gone_ != saved_;
    gone_ = saved_;
  }
  std::int64_t revision() const { return revision_; }
  /// Adds the volume at the outer ends to the particles' families, one entry per owned row.
  void add_bonded_volume(std::span<pd::BondedVolume> volumes) const;
  /// Local rows of the particles that lost such bonds to load are appended.
  void add_thinned(std::vector<Index>& rows) const;
  void add_bonded_volume(Index row, pd::BondedVolume& volume) const; ///< the same for one particle

  /// Appends pairs of local rows that the intact bonds hold together, in tied displacements. After `bind`.
  void add_joints(std::vector<std::array<Index, 2>>& pairs) const;

  std::size_t size() const { return bonds_.size(); }
  std::int64_t bonds() const; ///< intact ones that this rank counts; after `bind`

private:
  struct Panel;
  /// A bond's reference vector, taken apart once.
  struct Rest {
    Vector<Dim> along; ///< unit vector
    double length;     ///< [m]
  };
  bool starts_at_row(const CarriedBond<Dim>& bond) const;
  void fill_lanes() const;
  law::BondState<Dim> state_of(std::size_t number, const Vector<Dim>& eta, law::Kinematics kinematics) const;
  double free_strain(std::size_t number) const { return free_.empty() ? 0.0 : free_[number]; }
  void work_out_bound(std::span<double> blocks) const;
  void refresh_lanes() const;
  void refresh_runs() const;
  law::BondState<Dim> state_of(std::size_t number, std::span<const double> d, law::Kinematics kinematics) const;
  bool counted(const CarriedBond<Dim>& bond) const { return points_.rows(bond.a).front() < rows_.owned(); }
  /// Calls visit(number, stretch) for the intact bonds that a rule breaks at u.
  template <class Visit>
  void for_each_overstretched(std::span<const double> u, std::span<const pd::BreakRule> rules, Visit&& visit) const;
  const std::vector<std::pair<Index, pd::BondedVolume>>& volumes() const;
  void note_force(std::size_t number, law::Kinematics kinematics, field::ForceLosses& losses) const;
  Vector<Dim> stretch_vector(const CarriedBond<Dim>& bond, std::span<const double> d) const;
  template <class Visit> void for_each_group(Visit&& visit) const;

  field::Rows rows_;
  CarriedPoints<Dim> points_;
  bool bound_ = false;
  bool hands_ = false;                          // any mass
  mutable std::vector<double> stiffness_bound_; // of used_, when it was asked for first; empty: not yet
  Index moved_to_ = -1;                         // the patch that all bonds are of since rows moved, -1: they never did
  std::vector<Index> used_;
  std::vector<CarriedBond<Dim>> bonds_;
  std::vector<Rest> rest_;                 // per bond
  std::vector<double> free_;               // free strain per bond; empty: nothing swells [-]
  std::vector<std::uint8_t> gone_, saved_; // per bond: cut or broken
  std::int64_t revision_ = 0;              // of gone_
  law::Kinematics kinematics_;
  bool symmetric_;
  std::vector<double> state_;  // displacement of the points at the last linearisation
  std::vector<double> limits_; // per patch, of the stretch; empty: nobody watches [-]
  mutable bool overstretched_seen_ = false;
  mutable std::vector<double> spread_;
  std::unique_ptr<CarriedRuns<Dim>> runs_;       // of bonds along straight sides; null but in explicit steps
  mutable std::vector<CarriedLanes<Dim>> lanes_; // of other bonds from a row to few rows
  mutable std::vector<std::size_t> others_;      // numbers of those in neither
  mutable bool laid_out_ = false;                // in lanes and others, as runs are now
  mutable std::int64_t lanes_revision_ = -1;     // that lanes know
  mutable std::vector<std::pair<Index, pd::BondedVolume>>
      volumes_;                                // at the outer ends, ascending by the particle's row
  mutable std::int64_t volumes_revision_ = -1; // that they know
  Processor processor_ = chosen_processor();
};
} // namespace pdx::couple
