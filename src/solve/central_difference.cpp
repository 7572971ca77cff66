#include "waiting_kick.hpp"

#include <cmath>
#include <petsc/private/tsimpl.h>

namespace pdx::solve {
namespace {
constexpr double kSameTime = 1e-6; // of a step

struct CentralDifference {
  VecHandle acceleration;
  Motion motion;
  StepOrigin origin;
  bool fresh = false; ///< `acceleration` is that of the present state
  bool waits = false; ///< last kicks do
  double due = 0.0;   ///< step whose last kick waits; 0: none [s]
};
CentralDifference& data_of(TS ts) { return *static_cast<CentralDifference*>(ts->data); }

/// v += dt/2 a and, in the first half of a step, u += dt v; before that the kick of a step before that waited.
template <bool drift, bool waited>
void kick(double before, double dt, const double* a, double* v, double* u, PetscInt size)
{
  for (PetscInt i = 0; i < size; ++i) {
    if constexpr (waited) v[i] += 0.5 * before * a[i];
    v[i] += 0.5 * dt * a[i];
    if constexpr (drift) u[i] += dt * v[i];
  }
}

template <bool drift> void advance(TS ts, double dt, double end)
{
  CentralDifference& own = data_of(ts);
  PetscInt size = 0;
  const double* a = nullptr;
  double *u = nullptr, *v = nullptr;
  PDX_CALL(VecGetLocalSize(ts->vec_sol, &size));
  PDX_CALL(VecGetArrayRead(own.acceleration.get(), &a));
  PDX_CALL(VecGetArray(ts->vec_dot, &v));
  if constexpr (drift) PDX_CALL(VecGetArray(ts->vec_sol, &u));
  if (own.due > 0.0)
    kick<drift, true>(own.due, dt, a, v, u, size);
  else
    kick<drift, false>(0.0, dt, a, v, u, size);
  own.due = 0.0;
  if (drift && own.motion.displacement) own.motion.displacement(end, u);
  if (!drift && own.motion.velocity) own.motion.velocity(end, v);
  if constexpr (drift) PDX_CALL(VecRestoreArray(ts->vec_sol, &u));
  PDX_CALL(VecRestoreArray(ts->vec_dot, &v));
  PDX_CALL(VecRestoreArrayRead(own.acceleration.get(), &a));
}

/// What is held does not accelerate: the kick to come leaves it as it is.
void leave_kick(TS ts, double dt, double end)
{
  CentralDifference& own = data_of(ts);
  own.due = dt;
  if (!own.motion.velocity) return;
  double* v = nullptr;
  PDX_CALL(VecGetArray(ts->vec_dot, &v));
  own.motion.velocity(end, v);
  PDX_CALL(VecRestoreArray(ts->vec_dot, &v));
}

PetscErrorCode step(TS ts)
{
  return guard([&] {
    CentralDifference& own = data_of(ts);
    const double dt = ts->time_step;
    if (!own.fresh && !own.motion.whole) {
      PDX_CALL(TSComputeRHSFunction(ts, ts->ptime, ts->vec_sol, own.acceleration.get()));
      own.fresh = true;
    }
    if (dt != own.origin.length) own.origin = {ts->ptime, ts->steps, dt};
    double end = own.origin.time + (ts->steps - own.origin.step + 1) * dt;
    if (std::abs(end - ts->max_time) < kSameTime * dt) end = ts->max_time; // no step for a rounding
    PDX_CALL(TSPreStage(ts, ts->ptime));
    if (own.motion.whole)
      own.motion.whole(ts->ptime, end);
    else {
      advance<true>(ts, dt, end);
      PDX_CALL(TSComputeRHSFunction(ts, end, ts->vec_sol, own.acceleration.get()));
      if (own.waits)
        leave_kick(ts, dt, end);
      else
        advance<false>(ts, dt, end);
    }
    PDX_CALL(TSPostStage(ts, end, 0, &ts->vec_sol));
    PetscReal next = dt;
    PetscBool accept = PETSC_TRUE;
    // There is nothing to choose behind the last step, and PETSc from 3.19 on refuses one that ends late by a rounding.
    if (end < ts->max_time) PDX_CALL(TSAdaptChoose(ts->adapt, ts, dt, nullptr, &next, &accept));
    ts->ptime = end;
    ts->time_step = next;
  });
}

PetscErrorCode set_up(TS ts)
{
  return guard([&] {
    if (!ts->vec_dot) throw std::logic_error("central_difference needs a velocity: TS2SetSolution");
    CentralDifference& own = data_of(ts);
    PDX_CALL(VecDuplicate(ts->vec_sol, own.acceleration.out()));
    own.fresh = false;
    PDX_CALL(TSGetAdapt(ts, &ts->adapt));
    PDX_CALL(TSAdaptCandidatesClear(ts->adapt));
  });
}

PetscErrorCode reset(TS ts)
{
  data_of(ts).acceleration.reset();
  data_of(ts).fresh = false;
  return 0;
}

PetscErrorCode destroy(TS ts)
{
  delete static_cast<CentralDifference*>(ts->data);
  ts->data = nullptr;
  return 0;
}

PetscErrorCode create(TS ts)
{
  return guard([&] {
    ts->data = new CentralDifference;
    ts->ops->setup = set_up;
    ts->ops->step = step;
    ts->ops->reset = reset;
    ts->ops->destroy = destroy;
    ts->default_adapt_type = TSADAPTNONE;
    ts->usessnes = PETSC_FALSE;
  });
}
} // namespace

void register_central_difference() { PDX_CALL(TSRegister(kCentralDifference, create)); }

void set_motion(TS ts, Motion motion) { data_of(ts).motion = std::move(motion); }

void let_kicks_wait(TS ts) { data_of(ts).waits = true; }

void finish_kick(TS ts)
{
  CentralDifference& own = data_of(ts);
  if (own.due == 0.0) return;
  PetscInt size = 0;
  const double* a = nullptr;
  double* v = nullptr;
  PDX_CALL(VecGetLocalSize(ts->vec_dot, &size));
  PDX_CALL(VecGetArrayRead(own.acceleration.get(), &a));
  PDX_CALL(VecGetArray(ts->vec_dot, &v));
  kick<false, false>(0.0, own.due, a, v, nullptr, size);
  PDX_CALL(VecRestoreArray(ts->vec_dot, &v));
  PDX_CALL(VecRestoreArrayRead(own.acceleration.get(), &a));
  own.due = 0.0;
}

StepOrigin step_origin(TS ts) { return data_of(ts).origin; }

void resume_steps(TS ts, const StepOrigin& origin, Vec acceleration)
{
  CentralDifference& own = data_of(ts);
  own.origin = origin;
  PDX_CALL(VecCopy(acceleration, own.acceleration.get()));
  own.fresh = true;
  own.due = 0.0;
}

Vec acceleration(TS ts) { return data_of(ts).acceleration.get(); }
} // namespace pdx::solve
