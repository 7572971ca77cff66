#pragma once
#include "pdx/base/petsc.hpp"

#include <functional>
#include <petscts.h>

namespace pdx::solve {
using TsHandle = Handle<TS, TSDestroy>;
inline constexpr char kCentralDifference[] = "central_difference";

/// Makes `-ts_type central_difference` known to PETSc: velocity Verlet (kick, drift, kick), explicit, second order, one
/// evaluation per step of the right-hand side, which is the acceleration a(t, u). The solution is u, its rate v
/// (TS2SetSolution). Steps of one length end at multiples of it from where it was chosen, without a sum of roundings.
void register_central_difference();

/// What is prescribed: called with the displacement after the drift, and with the velocity after the last kick, to
/// overwrite held components for that time.
struct Motion {
  std::function<void(double time, double* u)> displacement;
  std::function<void(double time, double* v)> velocity;
  /// Takes the place of all that a step does with u, v and the acceleration, if there is one.
  std::function<void(double begin, double end)> whole;
};
void set_motion(TS ts, Motion motion);

/// Where a run stands between two steps besides u and v: with it a stopped run goes on to the last bit.
struct StepOrigin {
  double time = 0.0; ///< at which the step's length was chosen [s]
  int step = 0;
  double length = 0.0; ///< [s]; 0: none yet
};
StepOrigin step_origin(TS ts);
/// @param acceleration of the state the run goes on from, owned components   The TS must be set up.
void resume_steps(TS ts, const StepOrigin& origin, Vec acceleration);
Vec acceleration(TS ts); ///< at the end of the last step; borrowed. The TS must be set up.
} // namespace pdx::solve
