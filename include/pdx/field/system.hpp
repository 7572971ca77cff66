#pragma once
#include "pdx/field/after_solve.hpp"
#include "pdx/field/after_step.hpp"
#include "pdx/field/coarse_space.hpp"
#include "pdx/field/drive.hpp"
#include "pdx/field/own_steps.hpp"
#include "pdx/field/roller.hpp"
#include "pdx/field/support.hpp"

#include <memory>

namespace pdx::field {
/// Prescribed displacement of owned components: local component number = row * dim + direction.
struct Prescribed {
  std::vector<Index> components;
  std::vector<double> values; ///< at load 1 [m]
};

/// A prescribed component of what turns as a rigid body: at load l, with the angle l * `angle`, it is at
/// (cos - 1) along + sin across.
struct Turning {
  std::size_t at = 0;               ///< place among the prescribed components
  double angle = 0.0;               ///< at load 1 [rad]
  double along = 0.0, across = 0.0; ///< [m]
};

/// All that a solver knows of a scene: rows, Terms, loads and what is held. Solvers know Terms, never physics.
struct System {
  Rows rows;
  std::unique_ptr<RowHalo> halo;
  std::vector<std::unique_ptr<Term>> terms;
  std::unique_ptr<OwnSteps> steps;                    ///< null: forces of the Terms move the rows
  std::vector<std::unique_ptr<AfterSolve>> after;     ///< asked in this order after each solve
  std::vector<std::unique_ptr<AfterStep>> after_step; ///< asked in this order after each time step
  Prescribed prescribed;
  std::vector<Turning> turning;           ///< of these components; `prescribed.values` hold them at load 1
  std::vector<Roller> rollers;            ///< of owned rows, ascending; none of their components is prescribed
  bool rolls = false;                     ///< has any rank rollers? `bind` finds out
  std::vector<Support*> supports;         ///< borrowed from terms: springs, pins
  std::vector<std::uint8_t> held;         ///< 1 per prescribed component of every local row [owned | halo]
  std::vector<double> load;               ///< external force at load 1, owned rows * dim [N]
  std::vector<Drive> drives;              ///< the same in time: loads, and the motion of what is held
  std::vector<double> initial_velocity;   ///< owned rows * dim; empty: at rest [m/s]
  std::vector<double> coordinates;        ///< of owned rows, dim per row [m]
  std::unique_ptr<Swelling> swelling;     ///< none: no Term ever swells
  std::vector<double> mass, inverse_mass; ///< lumped, of owned rows; empty until `solve::know_mass` [kg], [1/kg]
  std::unique_ptr<CoarseSpace> coarse;    ///< none: assembled operators only
  double scale = 1.0;                     ///< diagonal of prescribed components [N/m]

  /// Finds the halo of all Terms, binds them and spreads `held`. Call once, after rows, terms and prescribed are set.
  /// Collective.
  void bind(const std::vector<PetscInt>& also_needed = {});
  /// Tells the Terms the free strain at a load, where there is any, and supports where they are.
  void go_to(double load) const;
  /// Where prescribed components are at a load, in their order [m].
  std::vector<double> targets(double load) const;
  bool linear() const;
  bool symmetric() const;
};
} // namespace pdx::field
