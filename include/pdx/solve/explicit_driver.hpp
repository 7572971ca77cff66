#pragma once
#include "pdx/solve/far_forces.hpp"
#include "pdx/solve/time_driver.hpp"

#include <optional>

namespace pdx::solve {
/// Length of the steps, besides PETSc's own `-ts_...`.
struct ExplicitOptions {
  double limit = 0.0;          ///< rigorous stable step of the scene [s]
  double safety = 0.9;         ///< share of it that a step takes by itself [-]
  bool allow_unstable = false; ///< let a given -ts_dt be above the limit
  int parts = 1;        ///< steps that particles, and elements beside them, take in one of the elements farther away
  bool goes_on = false; ///< of a run that has begun: `resume` and `resume_changed` judge what its steps were
};

/// Explicit dynamics: central differences, one evaluation of all forces per step, or one of elements away from
/// particles and several of all else. Rows move by their lumped mass; what is held follows its drives.
class ExplicitDriver final : public TimeDriver {
public:
  /// Throws UserError for a step above the limit, an end that is not given, a TS type that is not ours, or parts of
  /// steps where nothing is far or that save nothing. Collective.
  /// @param known displacement and velocity to go on from; none: those of the start
  ExplicitDriver(field::System& system, const ExplicitOptions& options, MovingSystem::Values known = {});

  std::span<const double> acceleration() const override;
  KineticEnergy kinetic_energy() const override;

private:
  void choose_step() const;
  void judge_step(double length) const override;
  double fitting_step(double length) const override;
  double
  even_step(double left) const; ///< as long as safety and limit allow, a whole number of which is what is left [s]
  void evaluate(double time, std::span<double> a);
  void step_alone(double begin, double end);
  void part_steps();
  void step_in_parts(double begin, double end);
  StepOrigin origin() const override { return step_origin(ts_.get()); }
  void set_acceleration(const StepOrigin& origin, std::span<const double> a) override;
  void start(double time, std::span<double> a) override;
  void start_again(double time, const StepOrigin& origin) override;
  void forces_again(double time) override;
  double last_part(double length) const override { return length / options_.parts; }
  void let_go(const field::ForceLosses& losses) override;

  ExplicitOptions options_;
  std::optional<FarForces> far_; // none: all is near
};
} // namespace pdx::solve
