#include "pdx/solve/explicit_driver.hpp"

#include "pdx/base/events.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::solve {
namespace {
constexpr int kCheckInterval = 20;       // steps from one look at the energy to the next
constexpr double kEnergyTolerance = 2.0; // kinetic energy over all that was put in, above which a run has gone wild

/// Values of a drive's components at a time: force, or displacement of what is held.
double factor(const field::Drive& drive, double time)
{
  return drive.kind == field::Drive::Kind::velocity ? drive.history.integral(time) : drive.history.value(time);
}
double rate(const field::Drive& drive, double time)
{
  return drive.kind == field::Drive::Kind::velocity ? drive.history.value(time) : drive.history.rate(time);
}
template <class Visit> void for_each_held(const std::vector<field::Drive>& drives, Visit&& visit)
{
  for (const field::Drive& drive : drives)
    if (drive.kind != field::Drive::Kind::force) visit(drive);
}
VecHandle vector_on(const field::Rows& rows, double* values)
{
  VecHandle v;
  PDX_CALL(VecCreateMPIWithArray(rows.comm, rows.dim, rows.dim * rows.owned(), PETSC_DETERMINE, values, v.out()));
  return v;
}
} // namespace

ExplicitDriver::ExplicitDriver(field::System& system, const ExplicitOptions& options)
    : system_(system), owned_(static_cast<std::size_t>(system.rows.owned() * system.rows.dim)),
      u_(static_cast<std::size_t>(system.halo->size() * system.rows.dim), 0.0), v_(system.initial_velocity)
{
  v_.resize(owned_, 0.0);
  mass_.assign(static_cast<std::size_t>(system.rows.owned()), 0.0);
  for (const auto& term : system.terms) {
    term->add_mass(mass_);
    term->ties(ties_);
  }
  for (const double m : mass_) inverse_mass_.push_back(1.0 / m);
  for (const field::Drive& drive : system.drives)
    if (drive.kind == field::Drive::Kind::force)
      loads_.push_back({&drive, std::vector<double>(drive.components.size(), 0.0)});
  displacement_ = vector_on(system.rows, u_.data());
  velocity_ = vector_on(system.rows, v_.data());

  register_central_difference();
  PDX_CALL(TSCreate(system.rows.comm, ts_.out()));
  PDX_CALL(TSSetProblemType(ts_.get(), TS_NONLINEAR));
  PDX_CALL(TSSetType(ts_.get(), kCentralDifference));
  PDX_CALL(TSSetMaxTime(ts_.get(), PETSC_MAX_REAL));
  PDX_CALL(TSSetMaxSteps(ts_.get(), PETSC_MAX_INT));
  PDX_CALL(TSSetExactFinalTime(ts_.get(), TS_EXACTFINALTIME_MATCHSTEP));
  PDX_CALL(TSSetFromOptions(ts_.get()));
  choose_step(options);
  PDX_CALL(TS2SetSolution(ts_.get(), displacement_.get(), velocity_.get()));
  PDX_CALL(TSSetApplicationContext(ts_.get(), this));
  PDX_CALL(TSSetRHSFunction(
      ts_.get(), nullptr,
      [](TS, PetscReal time, Vec, Vec a, void* self) {
        return guard([&] {
          double* values = nullptr;
          PDX_CALL(VecGetArray(a, &values));
          static_cast<ExplicitDriver*>(self)->accelerate(time, values);
          PDX_CALL(VecRestoreArray(a, &values));
        });
      },
      this));
  PDX_CALL(TSSetPostStep(ts_.get(), [](TS ts) {
    return guard([&] {
      void* self = nullptr;
      PDX_CALL(TSGetApplicationContext(ts, &self));
      static_cast<ExplicitDriver*>(self)->after_step();
    });
  }));
  set_motion(ts_.get(), {[this](double time, double* u) { move(time, u); },
                         [this](double time, double* v) { move_velocity(time, v); }});
  PDX_CALL(TSSetUp(ts_.get()));
}

void ExplicitDriver::choose_step(const ExplicitOptions& options)
{
  TS ts = ts_.get();
  PetscBool is_ours = PETSC_FALSE, given = PETSC_FALSE;
  PDX_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ts), kCentralDifference, &is_ours));
  TSType type = nullptr;
  PDX_CALL(TSGetType(ts, &type));
  if (!is_ours)
    throw UserError(fmt::format("-ts_type is {}: explicit dynamics takes {} only (-analysis implicit takes alpha2)",
                                type, kCentralDifference));
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-ts_dt", &given));
  PetscReal length = 0.0, end = 0.0;
  PetscInt most = 0;
  PDX_CALL(TSGetTimeStep(ts, &length));
  PDX_CALL(TSGetMaxTime(ts, &end));
  PDX_CALL(TSGetMaxSteps(ts, &most));
  const bool ends = end < PETSC_MAX_REAL;
  if (!ends && most == PETSC_MAX_INT)
    throw UserError("-ts_max_time is missing: give the end of the run in s (or -ts_max_steps)");
  if (ends && end <= 0.0) throw UserError(fmt::format("-ts_max_time is {}: must be above 0", end));
  if (!given) {
    length = options.safety * options.limit;
    if (ends) length = end / std::ceil(end / length * (1.0 - 1e-12));
  } else if (!(length > 0.0))
    throw UserError(fmt::format("-ts_dt is {}: must be above 0", length));
  else if (length > options.limit && !options.allow_unstable)
    throw UserError(
        fmt::format("-ts_dt is {:g}: above the stable limit of this scene, {:.6g} s; give at most {:.3g}, or "
                    "none, or -ts_allow_unstable to go on",
                    length, options.limit, options.safety * options.limit));
  PDX_CALL(TSSetTimeStep(ts, length));
}

/// Forces on w = u + factor a and on u instead of those on a and u.
void ExplicitDriver::untie(double* f) const
{
  const auto dim = static_cast<std::size_t>(system_.rows.dim);
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      double& far = f[static_cast<std::size_t>(t.set) * dim + d];
      far /= t.factor;
      f[static_cast<std::size_t>(t.row) * dim + d] -= far;
    }
}

/// The acceleration of a from those of w and u.
void ExplicitDriver::tie(double* a) const
{
  const auto dim = static_cast<std::size_t>(system_.rows.dim);
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      double& set = a[static_cast<std::size_t>(t.set) * dim + d];
      set = (set - a[static_cast<std::size_t>(t.row) * dim + d]) / t.factor;
    }
}

/// M a = loads - internal force.
void ExplicitDriver::accelerate(double time, double* a)
{
  static Event event("time_acceleration");
  const Timed timed(event);
  system_.halo->refresh(u_);
  std::fill_n(a, owned_, 0.0);
  for (const auto& term : system_.terms) term->add_residual(u_, {a, owned_});
  const auto& held = system_.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) held_[k] = a[held[k]];
  std::size_t at = 0;
  for (const Load& load : loads_) {
    const double now = factor(*load.drive, time);
    for (std::size_t k = 0; k < load.drive->components.size(); ++k) {
      load_[at] = now * load.drive->values[k];
      a[load.drive->components[k]] -= load_[at++];
    }
  }
  untie(a);
  const auto dim = static_cast<std::size_t>(system_.rows.dim);
  for (std::size_t row = 0; row < inverse_mass_.size(); ++row)
    for (std::size_t d = 0; d < dim; ++d) a[row * dim + d] *= -inverse_mass_[row];
  tie(a);
  for (const Index c : held) a[c] = 0.0;
}

void ExplicitDriver::move(double time, double* u) const
{
  for_each_held(system_.drives, [&](const field::Drive& drive) {
    const double now = factor(drive, time);
    for (std::size_t k = 0; k < drive.components.size(); ++k) u[drive.components[k]] = now * drive.values[k];
  });
}

void ExplicitDriver::move_velocity(double time, double* v) const
{
  for_each_held(system_.drives, [&](const field::Drive& drive) {
    const double now = rate(drive, time);
    for (std::size_t k = 0; k < drive.components.size(); ++k) v[drive.components[k]] = now * drive.values[k];
  });
}

double ExplicitDriver::held_kinetic() const
{
  double sum = 0.0;
  for (const Index c : system_.prescribed.components)
    sum += 0.5 * mass_[static_cast<std::size_t>(c / system_.rows.dim)] * v_[static_cast<std::size_t>(c)] *
           v_[static_cast<std::size_t>(c)];
  return sum;
}

void ExplicitDriver::note_before()
{
  for (Load& load : loads_)
    for (std::size_t k = 0; k < load.before.size(); ++k)
      load.before[k] = u_[static_cast<std::size_t>(load.drive->components[k])];
  load_before_ = load_;
  held_before_ = held_;
  const auto& held = system_.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) held_u_before_[k] = u_[static_cast<std::size_t>(held[k])];
  held_kinetic_before_ = held_kinetic();
}

/// Trapezoidal rule: for loads exact in the energy that the scheme conserves. What is held is moved against its
/// internal force and its own inertia.
void ExplicitDriver::book_work()
{
  std::size_t at = 0;
  for (const Load& load : loads_)
    for (std::size_t k = 0; k < load.before.size(); ++k, ++at)
      work_ += 0.5 * (load_before_[at] + load_[at]) *
               (u_[static_cast<std::size_t>(load.drive->components[k])] - load.before[k]);
  const auto& held = system_.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k)
    work_ += 0.5 * (held_before_[k] + held_[k]) * (u_[static_cast<std::size_t>(held[k])] - held_u_before_[k]);
  work_ += held_kinetic() - held_kinetic_before_;
}

KineticEnergy ExplicitDriver::kinetic_energy() const
{
  const auto dim = static_cast<std::size_t>(system_.rows.dim);
  const std::span<const double> a = acceleration();
  const double dt = step_length();
  double sums[2] = {0.0, 0.0};
  for (std::size_t row = 0; row < mass_.size(); ++row)
    for (std::size_t i = row * dim; i < (row + 1) * dim; ++i) {
      sums[0] += mass_[row] * v_[i] * v_[i];
      sums[1] += mass_[row] * a[i] * a[i];
    }
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      const std::size_t i = static_cast<std::size_t>(t.row) * dim + d, s = static_cast<std::size_t>(t.set) * dim + d;
      const double m = mass_[static_cast<std::size_t>(t.set)], v = v_[i] + t.factor * v_[s], w = a[i] + t.factor * a[s];
      sums[0] += m * (v * v - v_[s] * v_[s]);
      sums[1] += m * (w * w - a[s] * a[s]);
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, system_.rows.comm);
  return {0.5 * sums[0], dt * dt / 8.0 * sums[1]};
}

/// Kinetic energy comes from loads, motion and what was there; more than that, or no number at all, is a run gone wild.
bool ExplicitDriver::sound()
{
  const double kinetic = kinetic_energy().moving;
  double work = work_;
  MPI_Allreduce(MPI_IN_PLACE, &work, 1, MPI_DOUBLE, MPI_SUM, system_.rows.comm);
  energy_bound_ = std::max(energy_bound_, work + good_.clock.initial);
  return std::isfinite(kinetic) && std::isfinite(work) && kinetic <= kEnergyTolerance * energy_bound_;
}

void ExplicitDriver::after_step()
{
  for (const auto& change : system_.after_step) change->apply(u_);
  book_work();
  note_before();
  const bool last = step() >= expected_steps();
  if (step() % kCheckInterval == 0 || last) {
    if (!sound()) {
      const std::string why = describe_wildness();
      go_back();
      throw SolverFailure(why);
    }
    keep();
  }
  if (after_each_() == Verdict::stop) PDX_CALL(TSSetConvergedReason(ts_.get(), TS_CONVERGED_USER));
}

std::string ExplicitDriver::describe_wildness() const
{
  const auto dim = static_cast<std::size_t>(system_.rows.dim);
  struct {
    double speed;
    int rank;
  } fastest{-1.0, 0};
  MPI_Comm_rank(system_.rows.comm, &fastest.rank);
  const int me = fastest.rank;
  std::array<double, 3> place{};
  for (std::size_t row = 0; row < mass_.size(); ++row)
    for (std::size_t d = 0; d < dim; ++d) {
      const double raw = std::abs(v_[row * dim + d]);
      const double speed = std::isnan(raw) ? std::numeric_limits<double>::infinity() : raw;
      if (speed <= fastest.speed) continue;
      fastest.speed = speed;
      for (std::size_t e = 0; e < dim; ++e) place[e] = system_.coordinates[row * dim + e];
    }
  MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, system_.rows.comm);
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, fastest.rank, system_.rows.comm);
  (void)me;
  return fmt::format(
      "step {}, time {:.6g} s: the energy of motion grew beyond all work done, most near ({:g}, {:g}); the "
      "state of step {} is kept; try a smaller -ts_dt than {:.4g} s, or check material and units",
      step(), time(), place[0], place[1], good_.clock.step, step_length());
}

void ExplicitDriver::keep()
{
  good_.u.assign(u_.begin(), u_.end());
  good_.v = v_;
  const auto a = acceleration();
  good_.a.assign(a.begin(), a.end());
  good_.clock = clock();
  for (const auto& change : system_.after_step) change->save();
}

void ExplicitDriver::go_back()
{
  for (const auto& change : system_.after_step) change->restore();
  std::ranges::copy(good_.u, u_.begin());
  set_state(good_.clock, good_.a);
  v_ = good_.v;
}

void ExplicitDriver::set_state(const Clock& clock, std::span<const double> a)
{
  const VecHandle values = vector_on(system_.rows, const_cast<double*>(a.data())); // only read
  resume_steps(ts_.get(), clock.origin, values.get());
  PDX_CALL(TSSetTime(ts_.get(), clock.time));
  PDX_CALL(TSSetStepNumber(ts_.get(), clock.step));
  if (clock.origin.length > 0.0) PDX_CALL(TSSetTimeStep(ts_.get(), clock.length));
  work_ = clock.work;
  energy_bound_ = clock.energy_bound;
}

ExplicitDriver::Clock ExplicitDriver::clock() const
{
  return {time(), step(), step_length(), step_origin(ts_.get()), work_, energy_bound_, good_.clock.initial};
}

void ExplicitDriver::resume(const Clock& clock, std::span<const double> u, std::span<const double> v,
                            std::span<const double> a)
{
  std::ranges::copy(u, u_.begin());
  std::ranges::copy(v, v_.begin());
  good_.clock = clock;
  set_state(clock, a);
  resumed_ = true;
}

void ExplicitDriver::run(const AfterEach& after_each)
{
  after_each_ = after_each;
  held_.assign(system_.prescribed.components.size(), 0.0);
  held_u_before_ = held_;
  std::size_t loaded = 0;
  for (const Load& load : loads_) loaded += load.before.size();
  load_.assign(loaded, 0.0);
  std::vector<double> a(owned_, 0.0);
  if (resumed_) {
    const auto now = acceleration();
    a.assign(now.begin(), now.end());
    std::vector<double> again(owned_);
    accelerate(time(), again.data()); // for the forces on what is held and loaded
  } else {
    move(0.0, u_.data());
    move_velocity(0.0, v_.data());
    accelerate(0.0, a.data());
    set_state({}, a);
    good_.clock.initial = energy_bound_ = kinetic_energy().moving;
  }
  note_before();
  keep();
  PDX_CALL(TSSolve(ts_.get(), displacement_.get()));
  TSConvergedReason reason = TS_CONVERGED_ITERATING;
  PDX_CALL(TSGetConvergedReason(ts_.get(), &reason));
  if (reason < 0)
    throw SolverFailure(
        fmt::format("step {}, time {:.6g} s: TS stopped ({})", step(), time(), TSConvergedReasons[reason]));
}

double ExplicitDriver::time() const
{
  PetscReal time = 0.0;
  PDX_CALL(TSGetTime(ts_.get(), &time));
  return time;
}

int ExplicitDriver::step() const
{
  PetscInt step = 0;
  PDX_CALL(TSGetStepNumber(ts_.get(), &step));
  return step;
}

double ExplicitDriver::step_length() const
{
  PetscReal length = 0.0;
  PDX_CALL(TSGetTimeStep(ts_.get(), &length));
  return length;
}

int ExplicitDriver::expected_steps() const
{
  PetscReal end = 0.0;
  PetscInt most = 0;
  PDX_CALL(TSGetMaxTime(ts_.get(), &end));
  PDX_CALL(TSGetMaxSteps(ts_.get(), &most));
  const double left = std::ceil((end - time()) / step_length() - 1e-6);
  return static_cast<int>(std::min(static_cast<double>(most), step() + std::max(0.0, left)));
}

std::span<const double> ExplicitDriver::acceleration() const
{
  const double* values = nullptr;
  Vec a = pdx::solve::acceleration(ts_.get());
  PDX_CALL(VecGetArrayRead(a, &values));
  const std::span<const double> view{values, owned_};
  PDX_CALL(VecRestoreArrayRead(a, &values));
  return view;
}
} // namespace pdx::solve
