#include "pdx/solve/moving_system.hpp"

#include "pdx/solve/stable_step.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::solve {
namespace {
/// Of a force or of a held displacement.
double factor(const field::Drive& drive, double time)
{
  return drive.kind == field::Drive::Kind::velocity ? drive.history.integral(time) : drive.history.value(time);
}
double rate(const field::Drive& drive, double time)
{
  return drive.kind == field::Drive::Kind::velocity ? drive.history.value(time) : drive.history.rate(time);
}
/// What turns is at (cos - 1) values + sin across, or as fast as that changes.
void overwrite_turning(const field::Drive& drive, bool speed, double time, double* values)
{
  const double angle = drive.turn * drive.history.value(time), half = std::sin(0.5 * angle),
               spin = drive.turn * drive.history.rate(time);
  const double on_along = speed ? -spin * std::sin(angle) : -2.0 * half * half,
               on_across = speed ? spin * std::cos(angle) : std::sin(angle);
  for (std::size_t k = 0; k < drive.components.size(); ++k)
    values[drive.components[k]] = on_along * drive.values[k] + on_across * drive.across[k];
}

/// values[component] = value of each held component.
void overwrite(const std::vector<field::Drive>& drives, double (*now)(const field::Drive&, double), double time,
               double* values)
{
  for (const field::Drive& drive : drives) {
    if (drive.kind == field::Drive::Kind::force) continue;
    if (drive.kind == field::Drive::Kind::turn) {
      overwrite_turning(drive, now == rate, time, values);
      continue;
    }
    const double by = now(drive, time);
    for (std::size_t k = 0; k < drive.components.size(); ++k) values[drive.components[k]] = by * drive.values[k];
  }
}
} // namespace

MovingSystem::MovingSystem(field::System& given, Values known)
    : system(given), u(std::move(known.u)), v(std::move(known.v)), mass(given.mass), ties_(ties_of(given)),
      held_(given.prescribed.components.size(), 0.0), held_before_(held_), held_u_before_(held_),
      rolled_(given.rollers.size(), 0.0)
{
  know_mass(given);
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  const bool begins = v.empty();
  u.resize(static_cast<std::size_t>(given.halo->size()) * dim, 0.0);
  if (begins) v = given.initial_velocity;
  v.resize(static_cast<std::size_t>(system.rows.owned()) * dim, 0.0);
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim && begins; ++d) {
      double& set = v[static_cast<std::size_t>(t.set) * dim + d];
      set = (set - v[static_cast<std::size_t>(t.row) * dim + d]) / t.factor;
    }
  loose_ = loose_halves();
  for (const field::Drive& drive : system.drives)
    if (const std::vector<double> none(drive.components.size(), 0.0); drive.kind == field::Drive::Kind::force)
      loads_.push_back({&drive, none, none, none});
}

std::vector<MovingSystem::Loose> MovingSystem::loose_halves() const
{
  std::vector<Loose> found;
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  const auto& held = system.prescribed.components;
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      const std::size_t row = static_cast<std::size_t>(t.row) * dim + d,
                        set = static_cast<std::size_t>(t.set) * dim + d;
      if (!system.held[row] || system.held[set]) continue;
      const auto at = std::ranges::find(held, static_cast<Index>(row));
      found.push_back({row, set, static_cast<std::size_t>(at - held.begin()), t.factor});
    }
  return found;
}

void MovingSystem::unbalanced(double time, std::span<double> f)
{
  system.halo->refresh(u);
  std::ranges::fill(f, 0.0);
  for (field::Support* support : system.supports) support->go_to_time(time);
  busy_.resize(system.terms.size(), 0.0);
  for (std::size_t k = 0; k < busy_.size(); ++k) {
    const field::Term& term = *system.terms[k];
    const double begin = MPI_Wtime() - term.waited();
    if (!parted_.empty() && parted_[k])
      parted_[k]->add_near(u, f);
    else
      term.add_residual(u, f);
    busy_[k] += MPI_Wtime() - term.waited() - begin;
  }
  const auto& held = system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) held_[k] = f[static_cast<std::size_t>(held[k])];
  for (const Loose& half : loose_) held_[half.held] -= f[half.set] / half.factor; // that of the near half alone
  note_rolled(f);
  load_at(time);
  for (const Load& load : loads_)
    for (std::size_t k = 0; k < load.force.size(); ++k)
      f[static_cast<std::size_t>(load.drive->components[k])] -= load.force[k];
}

/// Of a node whose far half is free that of the near half alone.
void MovingSystem::note_rolled(std::span<const double> f)
{
  const int dim = system.rows.dim;
  for (std::size_t k = 0; k < rolled_.size(); ++k) rolled_[k] = system.rollers[k].part(dim, f.data());
  if (rolled_.empty()) return;
  for (const field::Tie& t : ties_) {
    if (!rollers_of(t.set).empty()) continue;
    for (const field::Roller& roller : rollers_of(t.row))
      rolled_[static_cast<std::size_t>(&roller - system.rollers.data())] -=
          field::Roller{t.set, roller.along}.part(dim, f.data()) / t.factor;
  }
}

std::span<const field::Roller> MovingSystem::rollers_of(Index row) const
{
  const auto [from, to] = std::ranges::equal_range(system.rollers, row, {}, &field::Roller::row);
  return {from, to};
}

void MovingSystem::add_damping(std::span<double> f)
{
  const auto damps = [](const auto& term) { return term->damps(); };
  if (std::ranges::none_of(system.terms, damps)) return;
  system.halo->fetch(v, system.rows.dim, all_velocities_);
  damping_.assign(owned(), 0.0);
  for (const auto& term : system.terms)
    if (damps(term)) term->add_damping(u, all_velocities_, damping_);
  const auto& held = system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) held_[k] += damping_[static_cast<std::size_t>(held[k])];
  for (std::size_t k = 0; k < rolled_.size(); ++k)
    rolled_[k] += system.rollers[k].part(system.rows.dim, damping_.data());
  power_ = 0.0;
  for (std::size_t i = 0; i < f.size(); ++i) {
    f[i] += damping_[i];
    power_ += damping_[i] * v[i];
  }
}

void MovingSystem::foresee_damping(std::span<const double> a, double step)
{
  damped_.power = 0.0;
  for (std::size_t i = 0; i < damping_.size(); ++i) damped_.power += damping_[i] * (v[i] + 0.5 * step * a[i]);
}

void MovingSystem::load_at(double time)
{
  for (Load& load : loads_) {
    const double now = factor(*load.drive, time);
    for (std::size_t k = 0; k < load.force.size(); ++k) { // what loads a held component is its holder's
      const auto component = static_cast<std::size_t>(load.drive->components[k]);
      const bool far = !far_rows_.empty() && far_rows_[component / static_cast<std::size_t>(system.rows.dim)];
      load.force[k] = far || system.held[component] ? 0.0 : now * load.drive->values[k];
    }
  }
}

void MovingSystem::resume(double time, double work, const Damped& damped, std::span<const double> held_force)
{
  work_ = work;
  damped_ = damped;
  const auto& held = system.prescribed.components;
  if (!held_force.empty()) {
    for (std::size_t k = 0; k < held.size(); ++k) held_[k] = held_force[static_cast<std::size_t>(held[k])];
    for (std::size_t k = 0; k < rolled_.size(); ++k)
      rolled_[k] = system.rollers[k].part(system.rows.dim, held_force.data());
  }
  load_at(time);
  for (field::Support* support : system.supports) support->go_to_time(time);
}

void MovingSystem::held_force(std::vector<double>& force) const
{
  near_held_force(force);
  const auto& held = system.prescribed.components;
  for (std::size_t k = 0; k < far_held_.size(); ++k) force[static_cast<std::size_t>(held[k])] += far_held_[k];
}

void MovingSystem::near_held_force(std::vector<double>& force) const
{
  force.assign(owned(), 0.0);
  const auto& held = system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) force[static_cast<std::size_t>(held[k])] = held_[k];
  for (std::size_t k = 0; k < rolled_.size(); ++k) system.rollers[k].add(system.rows.dim, rolled_[k], force.data());
}

double MovingSystem::stored_energy() const
{
  double sum = damped_.energy;
  for (const auto& term : system.terms) sum += term->energy(u);
  for (const auto& change : system.after_step) sum += change->dissipated();
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, system.rows.comm);
  return sum;
}

template <std::size_t Dim> void MovingSystem::divide_by_mass(std::span<double> f) const
{
  const std::vector<double>& inverse = system.inverse_mass;
  for (std::size_t row = 0; row < inverse.size(); ++row)
    for (std::size_t d = 0; d < Dim; ++d) f[row * Dim + d] *= -inverse[row];
}

void MovingSystem::accelerate(std::span<double> f) const
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  for (const field::Tie& t : ties_) // forces on w = u + factor a and on u instead of those on a and u
    for (std::size_t d = 0; d < dim; ++d) {
      double& far = f[static_cast<std::size_t>(t.set) * dim + d];
      far /= t.factor;
      f[static_cast<std::size_t>(t.row) * dim + d] -= far;
    }
  dim == 2 ? divide_by_mass<2>(f) : divide_by_mass<3>(f);
  if (!ties_.empty()) field::project(system.rollers, system.rows.dim, f.data()); // before halves that are free follow
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      const std::size_t row = static_cast<std::size_t>(t.row) * dim + d;
      double& set = f[static_cast<std::size_t>(t.set) * dim + d];
      set = (set - (system.held[row] ? 0.0 : f[row])) / t.factor;
    }
  for (const Index c : system.prescribed.components) f[static_cast<std::size_t>(c)] = 0.0;
  field::project(system.rollers, system.rows.dim, f.data());
}

void MovingSystem::let_go(std::span<const field::ForceLoss> losses, std::span<double> a)
{
  const auto& held = system.prescribed.components;
  for (const field::ForceLoss& loss : losses)
    if (system.held[static_cast<std::size_t>(loss.component)])
      held_[static_cast<std::size_t>(std::ranges::find(held, loss.component) - held.begin())] -= loss.force;
    else if (ties_.empty())
      a[static_cast<std::size_t>(loss.component)] +=
          system.inverse_mass[static_cast<std::size_t>(loss.component / system.rows.dim)] * loss.force;
  if (!rolled_.empty()) {
    for (const field::ForceLoss& loss : losses)
      for (const field::Roller& roller : rollers_of(loss.component / system.rows.dim))
        rolled_[static_cast<std::size_t>(&roller - system.rollers.data())] -=
            roller.along[loss.component % system.rows.dim] * loss.force;
    field::project(system.rollers, system.rows.dim, a.data());
  }
  for (const Loose& half : loose_)
    for (const field::ForceLoss& loss : losses)
      if (loss.component == static_cast<Index>(half.set)) held_[half.held] += loss.force / half.factor;
  if (ties_.empty()) return;
  change_.assign(owned(), 0.0); // ties pass forces on to other rows
  for (const field::ForceLoss& loss : losses) change_[static_cast<std::size_t>(loss.component)] -= loss.force;
  accelerate(change_);
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += change_[i];
}

void MovingSystem::add_inertia(std::span<const double> x, std::span<double> y) const
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  std::vector<std::uint8_t> tied(mass.size(), 0);
  for (const field::Tie& t : ties_) {
    tied[static_cast<std::size_t>(t.set)] = 1;
    for (std::size_t d = 0; d < dim; ++d) {
      const std::size_t i = static_cast<std::size_t>(t.row) * dim + d, s = static_cast<std::size_t>(t.set) * dim + d;
      const double far = mass[static_cast<std::size_t>(t.set)] * (x[i] + t.factor * x[s]);
      y[i] += far;
      y[s] += t.factor * far;
    }
  }
  for (std::size_t row = 0; row < mass.size(); ++row)
    for (std::size_t d = 0; d < dim && !tied[row]; ++d) y[row * dim + d] += mass[row] * x[row * dim + d];
}

void MovingSystem::move(double time, double* displacement) const
{
  overwrite(system.drives, factor, time, displacement);
  field::project(system.rollers, system.rows.dim, displacement);
}

void MovingSystem::move_velocity(double time, double* velocity) const
{
  overwrite(system.drives, rate, time, velocity);
  field::project(system.rollers, system.rows.dim, velocity);
}

template <class Move> void MovingSystem::without_far_halves(double* values, Move&& move) const
{
  std::vector<double> before;
  for (const Loose& half : loose_) before.push_back(values[half.row]);
  move();
  for (std::size_t k = 0; k < loose_.size(); ++k)
    values[loose_[k].set] -= (values[loose_[k].row] - before[k]) / loose_[k].factor;
}

void MovingSystem::move_alone(double time, double* displacement) const
{
  without_far_halves(displacement, [&] { move(time, displacement); });
}

void MovingSystem::move_velocity_alone(double time, double* velocity) const
{
  without_far_halves(velocity, [&] { move_velocity(time, velocity); });
}

double MovingSystem::astray(double time) const
{
  std::vector<double> right(u);
  move(time, right.data());
  double most[2] = {0.0, 0.0}; // distance, size
  for (const Index c : system.prescribed.components) {
    const auto i = static_cast<std::size_t>(c);
    most[0] = std::max(most[0], std::abs(right[i] - u[i]));
    most[1] = std::max({most[1], std::abs(right[i]), std::abs(u[i])});
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, system.rows.comm);
  return most[1] > 0.0 ? most[0] / most[1] : 0.0;
}

double MovingSystem::held_kinetic() const
{
  double sum = 0.0;
  for (const Index c : system.prescribed.components) {
    const double speed = v[static_cast<std::size_t>(c)];
    sum += 0.5 * mass[static_cast<std::size_t>(c / system.rows.dim)] * speed * speed;
  }
  return sum;
}

void MovingSystem::note()
{
  for (Load& load : loads_) {
    load.force_before = load.force;
    for (std::size_t k = 0; k < load.u_before.size(); ++k)
      load.u_before[k] = u[static_cast<std::size_t>(load.drive->components[k])];
  }
  held_before_ = held_;
  const auto& held = system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) held_u_before_[k] = u[static_cast<std::size_t>(held[k])];
  held_kinetic_before_ = held_kinetic();
  for (field::Support* support : system.supports) support->note(u);
}

void MovingSystem::book(double length)
{
  damped_.energy += 0.5 * length * (damped_.power + power_);
  for (const Load& load : loads_)
    for (std::size_t k = 0; k < load.force.size(); ++k)
      work_ += 0.5 * (load.force_before[k] + load.force[k]) *
               (u[static_cast<std::size_t>(load.drive->components[k])] - load.u_before[k]);
  const auto& held = system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k)
    work_ += 0.5 * (held_before_[k] + held_[k]) * (u[static_cast<std::size_t>(held[k])] - held_u_before_[k]);
  work_ += held_kinetic() - held_kinetic_before_;
  for (const field::Support* support : system.supports) work_ += support->work_since(u);
}
} // namespace pdx::solve
