#pragma once
#include "pdx/couple/carried_bonds.hpp"
#include "pdx/field/after_solve.hpp"
#include "pdx/pd/bond_term.hpp"

#include <optional>
#include <type_traits>

namespace pdx::couple {
/// Which of the overstretched bonds a pass breaks. all: every one. worst: a share of them, those with the largest
/// s / s0, and what is as much stretched to 1e-6, so that symmetric bonds go together.
enum class Release { all, worst };

struct FractureRule {
  std::vector<double> critical_stretch; ///< s0 per patch; bonds with s > s0 break          [-]
  std::vector<geom::Box<2>> no_fail;    ///< lattice bonds with an end in one never break; carried bonds say it
                                        ///< themselves                                     [m]
  Release release = Release::all;
  double release_share = 0.1; ///< of the overstretched bonds, at least one; worst only     [-]
  law::Kinematics kinematics = law::Kinematics::finite;
};

/// Breaks bonds after each solve: those between particles and those that leave their patch, by one rule and at one
/// displacement. A broken bond never heals.
class Fracture final : public field::AfterSolve {
public:
  /// After the precrack was cut, once the Terms are bound. Throws UserError for stretches or a share that are not
  /// positive, and for a number of stretches that is not that of the patches.
  /// @param carried may be null; outlive this, as `bonds`
  Fracture(pd::BondTerm<2>& bonds, CarriedBonds<2>* carried, FractureRule options);

  std::int64_t apply(std::span<const double> u) override;
  void save() override;
  void restore() override;

  /// Goes on from what was broken before, on all ranks; the bonds themselves are broken already.
  void resume(const pd::Broken& all) { now_ = all; }
  const pd::Broken& all() const { return now_; }     ///< of all ranks, since the start
  std::int64_t broken() const { return now_.bonds; } ///< on all ranks, since the start [-]
  double dissipated() const { return now_.energy; }  ///< strain energy of the bonds when they broke, all ranks [J]

private:
  std::vector<pd::BreakRule> rules(double scale) const;
  std::optional<double> worst_scale(const pd::BondTerm<2>::Windows& loaded, std::span<const double> u) const;

  pd::BondTerm<2>& bonds_;
  CarriedBonds<2>* carried_;
  FractureRule options_;
  MPI_Comm comm_;
  pd::Broken now_, saved_;
};

/// One entry per owned particle, in order of rows.                                          [-]
struct ParticleDamage {
  std::vector<double> damage;   ///< of bonds that broke  [XPD1 Eq. 9]
  std::vector<double> precrack; ///< of bonds that were cut from the start
};
/// Carried bonds included. @param carried may be null
template <int Dim>
ParticleDamage particle_damage(const field::Rows& rows, const pd::BondTerm<Dim>& bonds,
                               const std::type_identity_t<CarriedBonds<Dim>>* carried);

/// A particle that lost bonds to load.
struct Damaged {
  Index particle; ///< number among the owned ones
  double damage;  ///< `ParticleDamage::damage`, above 0 [-]
};
/// All of them, ascending, in time that grows little with those that lost none. @param carried may be null
std::vector<Damaged> damaged_particles(const field::Rows& rows, const pd::BondTerm<2>& bonds,
                                       const CarriedBonds<2>* carried);
} // namespace pdx::couple
