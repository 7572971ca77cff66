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

ExplicitDriver::ExplicitDriver(field::System& system, const ExplicitOptions& options, MovingSystem::Values known)
    : TimeDriver(system, std::move(known)), options_(options)
{
  register_central_difference();
  if (options_.parts > 1) part_steps();
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
  if (far_) set_motion(ts_.get(), {{}, {}, [this](double begin, double end) { step_in_parts(begin, end); }});
  PDX_CALL(TSSetUp(ts_.get()));
  if (far_) return;
  const auto damps = [](const auto& term) { return term->damps(); };
  if (!system.steps && std::ranges::none_of(system.terms, damps) && ties_of(system).empty()) let_kicks_wait(ts_.get());
}

/// A run that goes on is not judged again: patches move, and what is far with them.
void ExplicitDriver::part_steps()
{
  const field::System& system = moving_.system;
  const int parts = options_.parts;
  const auto damps = [](const auto& term) { return term->damps(); };
  if (system.steps || std::ranges::any_of(system.terms, damps))
    throw UserError(fmt::format("-ts_subcycle is {}: must be 1 with material points", parts));
  far_.emplace(moving_);
  const double far = far_->limit(), near = options_.limit;
  if (!options_.goes_on && !far_->any())
    throw UserError(fmt::format("-ts_subcycle is {}: must be 1 here, as no elements lie away from particles", parts));
  if (const int most = static_cast<int>(std::min(1e6, std::ceil(far / near * (1.0 - 1e-9))));
      !options_.goes_on && parts > most)
    throw UserError(fmt::format("-ts_subcycle is {}: must be at most {} here, as elements away from particles allow "
                                "steps of {:.4g} s and all else {:.4g} s",
                                parts, most, far, near));
  options_.limit = std::min(parts * near, far);
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

void ExplicitDriver::step_in_parts(double begin, double end)
{
  double* values = nullptr;
  Vec of_near = pdx::solve::acceleration(ts_.get());
  PDX_CALL(VecGetArray(of_near, &values));
  const std::span<double> a{values, moving_.owned()};
  const auto dim = static_cast<std::size_t>(moving_.system.rows.dim);
  const double part = last_part(end - begin);
  const auto each = [dim](std::span<const Index> rows, auto&& visit) {
    for (const Index row : rows)
      for (std::size_t i = static_cast<std::size_t>(row) * dim; i < (static_cast<std::size_t>(row) + 1) * dim; ++i)
        visit(i);
  };
  std::vector<double>&u = moving_.u, &v = moving_.v;
  const auto push = [&] {
    const std::span<const double> far = far_->acceleration();
    for (std::size_t i = 0; i < v.size(); ++i) v[i] += 0.5 * (end - begin) * far[i];
  };
  far_->begin();
  push();
  each(far_->rows(), [&](std::size_t i) { u[i] += (end - begin) * v[i]; });
  for (int k = 1; k <= options_.parts; ++k) {
    const double now = k == options_.parts ? end : begin + k * part;
    each(far_->near_rows(), [&](std::size_t i) {
      v[i] += 0.5 * part * a[i];
      u[i] += part * v[i];
    });
    moving_.move_alone(now, u.data());
    evaluate(now, a);
    each(far_->near_rows(), [&](std::size_t i) { v[i] += 0.5 * part * a[i]; });
    if (k == options_.parts) break;
    moving_.move_velocity_alone(now, v.data());
    part_ended(part);
  }
  far_->evaluate(end);
  push();
  moving_.move_velocity_alone(end, v.data());
  far_->book();
  PDX_CALL(VecRestoreArray(of_near, &values));
}

/// What is far is worked out by where all is.
void ExplicitDriver::forces_again(double time)
{
  if (!far_) return;
  moving_.system.halo->refresh(moving_.u);
  far_->evaluate(time);
}

KineticEnergy ExplicitDriver::kinetic_energy() const
{
  catch_up();
  KineticEnergy energy = moving_.kinetic_energy(acceleration(), last_part(step_length()));
  if (far_) energy.scheme += moving_.kinetic_energy(far_->acceleration(), step_length()).scheme;
  return energy;
}

void ExplicitDriver::start(double time, std::span<double> a)
{
  moving_.move_alone(time, moving_.u.data());
  moving_.move_velocity_alone(time, moving_.v.data());
  evaluate(time, a);
  forces_again(time);
}

void ExplicitDriver::start_again(double time, const StepOrigin& origin)
{
  double* values = nullptr;
  Vec a = pdx::solve::acceleration(ts_.get());
  PDX_CALL(VecGetArray(a, &values));
  start(time, {values, moving_.owned()});
  PDX_CALL(VecRestoreArray(a, &values));
  resume_steps(ts_.get(), origin, a);
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
