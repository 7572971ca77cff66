#include "pdx/solve/time_driver.hpp"

#include "waiting_kick.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::solve {
namespace {
constexpr int kCheckInterval = 20;       // steps from one look at the energy to the next
constexpr double kEnergyTolerance = 2.0; // kinetic energy over all that was put in, above which a run has gone wild
constexpr int kLedgerInterval = 100;     // steps from one look at all energies to the next, where something can break
constexpr double kJump = 1e-9;           // of the largest held displacement, at a restart
constexpr double kLostShare = 0.25;      // of all that was put in, gained or lost, above which a run has gone wild

/// What one of PETSc's TSGet... says.
template <class Value> Value asked(TS ts, PetscErrorCode (*get)(TS, Value*))
{
  Value value{};
  PDX_CALL(get(ts, &value));
  return value;
}

VecHandle vector_on(const field::Rows& rows, double* values)
{
  VecHandle v;
  PDX_CALL(VecCreateMPIWithArray(rows.comm, rows.dim, rows.dim * rows.owned(), PETSC_DETERMINE, values, v.out()));
  return v;
}
} // namespace

TimeDriver::TimeDriver(field::System& system, MovingSystem::Values known)
    : moving_(system, std::move(known)), displacement_(vector_on(system.rows, moving_.u.data())),
      velocity_(vector_on(system.rows, moving_.v.data())), told_u_(moving_.u.data(), moving_.owned()),
      told_v_(moving_.v)
{}

void TimeDriver::make_ts(const char* type)
{
  PDX_CALL(TSCreate(moving_.system.rows.comm, ts_.out()));
  TS ts = ts_.get();
  PDX_CALL(TSSetProblemType(ts, TS_NONLINEAR));
  PDX_CALL(TSSetType(ts, type));
  PDX_CALL(TSSetMaxTime(ts, PETSC_MAX_REAL));
  PDX_CALL(TSSetMaxSteps(ts, PETSC_MAX_INT));
  PDX_CALL(TSSetFromOptions(ts));
  PDX_CALL(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_MATCHSTEP));
  PDX_CALL(TSSetErrorIfStepFails(ts, PETSC_FALSE)); // `run` says it in our words
  if (const double begin = time(); begin != 0.0)
    throw UserError(fmt::format("-ts_init_time is {:g}: runs begin at 0", begin));
  const TSType chosen = asked(ts, TSGetType);
  if (std::string_view(chosen) != type)
    throw UserError(fmt::format("-ts_type is {}: must be {} here (-analysis explicit takes {}, implicit alpha2)",
                                chosen, type, kCentralDifference));
  PDX_CALL(TS2SetSolution(ts, displacement_.get(), velocity_.get()));
  PDX_CALL(TSSetApplicationContext(ts, this));
  PDX_CALL(TSSetPostStep(ts, [](TS now) {
    return guard([&] {
      void* self = nullptr;
      PDX_CALL(TSGetApplicationContext(now, &self));
      static_cast<TimeDriver*>(self)->after_step();
    });
  }));
}

double TimeDriver::given_step() const
{
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-ts_dt", &given));
  const double length = step_length(), end = end_time();
  if (end == PETSC_MAX_REAL && most_steps() == PETSC_MAX_INT)
    throw UserError("-ts_max_time is missing: give the end of the run in s (or -ts_max_steps)");
  if (end <= 0.0) throw UserError(fmt::format("-ts_max_time is {}: must be above 0", end));
  if (given && !(length > 0.0)) throw UserError(fmt::format("-ts_dt is {}: must be above 0", length));
  return given ? length : 0.0;
}

void TimeDriver::set_step(double length) const { PDX_CALL(TSSetTimeStep(ts_.get(), length)); }

/// Kinetic energy comes from loads, motion and what was there; more than that, or no number at all, is a run gone wild.
bool TimeDriver::sound()
{
  const bool all_looked_at = !moving_.system.after_step.empty() && step() % kLedgerInterval == 0;
  catch_up();
  const KineticEnergy energy = all_looked_at ? kinetic_energy() : moving_.kinetic_energy({}, 0.0);
  double work = moving_.work();
  MPI_Allreduce(MPI_IN_PLACE, &work, 1, MPI_DOUBLE, MPI_SUM, moving_.system.rows.comm);
  energy_bound_ = std::max(energy_bound_, work + start_bound_);
  if (!std::isfinite(energy.moving) || !std::isfinite(work) || energy.moving > kEnergyTolerance * energy_bound_)
    return false;
  if (!all_looked_at) return true;
  const double all =
      energy.moving - energy.scheme + moving_.stored_energy(); // breaking hides what an unstable step makes
  return std::abs(all - good_.clock.initial - work) <= kLostShare * energy_bound_;
}

void TimeDriver::refuse_unsound()
{
  if (sound()) return;
  catch_up();
  const auto place = moving_.fastest_place();
  const std::string why =
      fmt::format("step {}, time {:.6g} s: the energy of motion grew beyond all work done, fastest at ({:g}, "
                  "{:g}) from the body's corner; the state of "
                  "step {} is kept; try a smaller -ts_dt than {:.4g} s, or check material and units",
                  step(), time(), place[0], place[1], good_.clock.step, step_length());
  go_back();
  throw SolverFailure(why);
}

void TimeDriver::book_and_break(double length)
{
  moving_.book(length);
  losses_.clear();
  for (const auto& change : moving_.system.after_step) {
    change->stepped(length);
    change->apply(moving_.u, losses_);
  }
  if (!losses_.empty()) {
    catch_up(); // by the acceleration of the step that ended
    let_go(losses_);
  }
}

void TimeDriver::part_ended(double length)
{
  book_and_break(length);
  moving_.note();
}

void TimeDriver::after_step()
{
  after_evaluations();
  book_and_break(last_part(time() - asked(ts_.get(), TSGetPrevTime)));
  moving_.foresee_damping(acceleration(), step_length());
  moving_.note();
  if (step() % kCheckInterval == 0 || step() >= expected_steps()) {
    refuse_unsound();
    keep();
  }
  verdict_ = after_each_();
  if (verdict_ == Verdict::relayout && good_.clock.step != step()) { // the next driver keeps this state unseen
    const double bound = energy_bound_;                              // which looks at other steps must not change
    refuse_unsound();
    energy_bound_ = bound;
  }
  if (verdict_ != Verdict::go_on) PDX_CALL(TSSetConvergedReason(ts_.get(), TS_CONVERGED_USER));
}

void TimeDriver::keep()
{
  copy_state(good_.state);
  good_.clock = clock();
  for (const auto& change : moving_.system.after_step) change->save();
}

void TimeDriver::go_back()
{
  for (const auto& change : moving_.system.after_step) change->restore();
  set_state(good_.clock, good_.state);
  forces_again(good_.clock.time);
}

void TimeDriver::catch_up() const
{
  if (behind_ > 0.0) {
    if (moving_.system.steps)
      moving_.system.steps->tell(behind_, told_u_, told_v_);
    else
      finish_kick(ts_.get());
  }
  behind_ = 0.0;
}

void TimeDriver::copy_state(field::State& to) const
{
  catch_up();
  if (moving_.system.steps) moving_.system.steps->inner(to.inner);
  const auto owned = static_cast<std::ptrdiff_t>(moving_.owned());
  to.u.assign(moving_.u.begin(), moving_.u.begin() + owned);
  to.v = moving_.v;
  const auto a = acceleration();
  to.a.assign(a.begin(), a.end());
  moving_.near_held_force(to.held);
}

field::State TimeDriver::state() const
{
  field::State now;
  copy_state(now);
  return now;
}

void TimeDriver::set_state(const Clock& clock, const field::State& state)
{
  if (moving_.system.steps) moving_.system.steps->resume(clock.time, state.inner, clock.work);
  behind_ = 0.0;
  std::ranges::copy(state.u, moving_.u.begin());
  std::ranges::copy(state.v, moving_.v.begin());
  set_acceleration(clock.origin, state.a);
  set_clock(clock, state.held);
}

/// @param held force where something is; empty: it is not known
void TimeDriver::set_clock(const Clock& clock, std::span<const double> held)
{
  PDX_CALL(TSSetTime(ts_.get(), clock.time));
  PDX_CALL(TSSetStepNumber(ts_.get(), clock.step));
  if (clock.length > 0.0) set_step(clock.length);
  moving_.resume(clock.time, clock.work, clock.damped, held);
  energy_bound_ = clock.energy_bound;
  start_bound_ = clock.start_bound;
}

TimeDriver::Clock TimeDriver::clock() const
{
  return {time(),       step(),          step_length(), origin(), moving_.work(), energy_bound_, good_.clock.initial,
          start_bound_, moving_.damped()};
}

void TimeDriver::resume(const Clock& clock, const field::State& state)
{
  good_.clock = clock;
  set_state(clock, state);
  moving_.system.halo->refresh(moving_.u);
  forces_again(clock.time);
  if (moving_.astray(clock.time) > kJump)
    throw UserError(fmt::format("-restart: what is held would jump at {:g} s: give the displacements, velocities and "
                                "histories up to then that the run had",
                                clock.time));
  resumed_ = true;
}

void TimeDriver::resume_changed(const Clock& clock)
{
  good_.clock = clock;
  behind_ = 0.0;
  set_clock(clock, {});
  set_step(fitting_step(clock.length));
  start_again(clock.time, clock.origin);
  moving_.foresee_damping(acceleration(), step_length());
  resumed_ = true;
}

void TimeDriver::start_again(double time, const StepOrigin& origin)
{
  std::vector<double> a(moving_.owned(), 0.0);
  start(time, a);
  set_acceleration(origin, a);
}

MovingSystem::Values TimeDriver::give_up()
{
  catch_up();
  return {std::move(moving_.u), std::move(moving_.v)};
}

TimeDriver::Verdict TimeDriver::run(const AfterEach& after_each)
{
  after_each_ = after_each;
  if (!resumed_) {
    std::vector<double> a(moving_.owned(), 0.0);
    start(0.0, a);
    set_acceleration({}, a);
    moving_.foresee_damping(a, step_length());
    const KineticEnergy energy = kinetic_energy();
    const double stored = moving_.stored_energy();
    good_.clock.initial = energy.moving - energy.scheme + stored;
    energy_bound_ = start_bound_ = energy.moving + energy.scheme + stored;
  } else
    refuse_spent_run();
  moving_.note();
  keep();
  PDX_CALL(TSSolve(ts_.get(), displacement_.get()));
  if (const TSConvergedReason reason = asked(ts_.get(), TSGetConvergedReason); reason < 0)
    throw SolverFailure(fmt::format("step {}, time {:.6g} s: TS stopped ({}); try a smaller -ts_dt", step() + 1, time(),
                                    TSConvergedReasons[reason]));
  return verdict_;
}

void TimeDriver::refuse_spent_run() const
{
  if (time() > end_time() || step() > most_steps() || !(step_length() > 0.0))
    throw UserError(
        fmt::format("-restart: the checkpoint is at step {}, time {:g} s, beyond the end of this run; give a "
                    "later -ts_max_time or -ts_max_steps",
                    step(), time()));
  judge_step(step_length());
}

double TimeDriver::time() const { return asked(ts_.get(), TSGetTime); }
int TimeDriver::step() const { return asked(ts_.get(), TSGetStepNumber); }
double TimeDriver::step_length() const { return asked(ts_.get(), TSGetTimeStep); }
double TimeDriver::end_time() const { return asked(ts_.get(), TSGetMaxTime); }
int TimeDriver::most_steps() const { return asked(ts_.get(), TSGetMaxSteps); }

int TimeDriver::expected_steps() const
{
  const double left = std::ceil((end_time() - time()) / step_length() - 1e-6);
  return static_cast<int>(std::min(static_cast<double>(most_steps()), step() + std::max(0.0, left)));
}
} // namespace pdx::solve
