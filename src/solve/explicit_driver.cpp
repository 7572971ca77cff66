#include "pdx/solve/explicit_driver.hpp"

#include "pdx/base/events.hpp"
#include "pdx/solve/stable_step.hpp"
#include "waiting_kick.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::solve {
namespace {
constexpr double kSafer = 1.1; // by as much a step may be nearer to the limit than asked for, before it is shortened
} // namespace

ExplicitDriver::ExplicitDriver(field::System& system, const ExplicitOptions& options)
    : TimeDriver(system), options_(options)
{
  register_central_difference();
  make_ts(kCentralDifference);
  choose_step();
  PDX_CALL(TSSetRHSFunction(
      ts_.get(), nullptr,
      [](TS, PetscReal time, Vec, Vec a, void* self) {
        return guard([&] {
          auto& driver = *static_cast<ExplicitDriver*>(self);
          double* values = nullptr;
          PDX_CALL(VecGetArray(a, &values));
          driver.evaluate(time, {values, driver.moving_.owned()});
          PDX_CALL(VecRestoreArray(a, &values));
          driver.fall_behind(driver.step_length()); // the last kick may wait
        });
      },
      this));
  set_motion(ts_.get(), {[this](double time, double* u) { moving_.move_alone(time, u); },
                         [this](double time, double* v) { moving_.move_velocity_alone(time, v); },
                         {}});
  if (system.steps) set_motion(ts_.get(), {{}, {}, [this](double begin, double end) { step_alone(begin, end); }});
  PDX_CALL(TSSetUp(ts_.get()));
  const auto damps = [](const auto& term) { return term->damps(); };
  if (!system.steps && std::ranges::none_of(system.terms, damps) && ties_of(system).empty()) let_kicks_wait(ts_.get());
}

void ExplicitDriver::choose_step() const
{
  double length = given_step();
  PetscReal end = 0.0;
  PDX_CALL(TSGetMaxTime(ts_.get(), &end));
  if (length == 0.0) {
    if (!std::isfinite(options_.limit)) throw UserError("-ts_dt is missing: nothing in this scene limits the step");
    length = even_step(end);
  } else if (!options_.goes_on)
    judge_step(length);
  set_step(length);
}

void ExplicitDriver::judge_step(double length) const
{
  if (length <= options_.limit || options_.allow_unstable) return;
  throw UserError(
      fmt::format("-ts_dt is {:g}: above the stable limit of this scene, {:.6g} s; give at most {:.3g}, or none, or "
                  "-ts_allow_unstable to go on",
                  length, options_.limit, options_.safety * options_.limit));
}

double ExplicitDriver::fitting_step(double length) const
{
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-ts_dt", &given));
  const double near = given ? 1.0 : std::min(1.0, kSafer * options_.safety);
  if (options_.allow_unstable || length <= near * options_.limit) return length;
  return even_step(end_time() < PETSC_MAX_REAL ? end_time() - time() : PETSC_MAX_REAL);
}

double ExplicitDriver::even_step(double left) const
{
  const double longest = options_.safety * options_.limit;
  return left < PETSC_MAX_REAL && left > 0.0 ? left / std::ceil(left / longest * (1.0 - 1e-12)) : longest;
}

void ExplicitDriver::evaluate(double time, std::span<double> a)
{
  static Event event("time_acceleration");
  const Timed timed(event);
  moving_.unbalanced(time, a);
  moving_.add_damping(a);
  moving_.accelerate(a);
}

void ExplicitDriver::step_alone(double begin, double end)
{
  static Event event("time_own_step");
  const Timed timed(event);
  try {
    moving_.system.steps->step(begin, end, step() == 0);
  } catch (const SolverFailure& failure) {
    const std::string why =
        fmt::format("step {}, time {:.6g} s: {}; the state of step {} is kept; try a smaller -ts_dt "
                    "than {:.4g} s, or check material and units",
                    step() + 1, end, failure.what(), good_step(), step_length());
    go_back();
    throw SolverFailure(why);
  }
  moving_.set_work(moving_.system.steps->work());
  fall_behind(end - begin);
}

KineticEnergy ExplicitDriver::kinetic_energy() const
{
  catch_up();
  return moving_.kinetic_energy(acceleration(), step_length());
}

void ExplicitDriver::start(double time, std::span<double> a)
{
  moving_.move_alone(time, moving_.u.data());
  moving_.move_velocity_alone(time, moving_.v.data());
  evaluate(time, a);
}

void ExplicitDriver::set_acceleration(const StepOrigin& origin, std::span<const double> a)
{
  VecHandle values;
  PDX_CALL(VecDuplicate(displacement_.get(), values.out()));
  double* into = nullptr;
  PDX_CALL(VecGetArray(values.get(), &into));
  std::ranges::copy(a, into);
  PDX_CALL(VecRestoreArray(values.get(), &into));
  resume_steps(ts_.get(), origin, values.get());
}

void ExplicitDriver::let_go(const field::ForceLosses& losses)
{
  double* values = nullptr;
  Vec a = pdx::solve::acceleration(ts_.get());
  PDX_CALL(VecGetArray(a, &values));
  moving_.let_go(losses, {values, moving_.owned()});
  PDX_CALL(VecRestoreArray(a, &values));
}

std::span<const double> ExplicitDriver::acceleration() const
{
  const double* values = nullptr;
  Vec a = pdx::solve::acceleration(ts_.get());
  PDX_CALL(VecGetArrayRead(a, &values));
  const std::span<const double> view{values, moving_.owned()};
  PDX_CALL(VecRestoreArrayRead(a, &values));
  return view;
}
} // namespace pdx::solve
