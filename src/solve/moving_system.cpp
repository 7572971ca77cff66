#include "pdx/solve/moving_system.hpp"

#include "pdx/base/lanes.hpp"
#include "pdx/solve/stable_step.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
/// values[component] = value of each held component.
void overwrite(const std::vector<field::Drive>& drives, double (*now)(const field::Drive&, double), double time,
               double* values)
{
  for (const field::Drive& drive : drives) {
    if (drive.kind == field::Drive::Kind::force) continue;
    const double by = now(drive, time);
    for (std::size_t k = 0; k < drive.components.size(); ++k) values[drive.components[k]] = by * drive.values[k];
  }
}
} // namespace

MovingSystem::MovingSystem(field::System& given)
    : system(given), u(static_cast<std::size_t>(given.halo->size() * given.rows.dim), 0.0), v(given.initial_velocity),
      mass(lumped_mass(given)), ties_(ties_of(given)), held_(given.prescribed.components.size(), 0.0),
      held_before_(held_), held_u_before_(held_)
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  v.resize(static_cast<std::size_t>(system.rows.owned()) * dim, 0.0);
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      double& set = v[static_cast<std::size_t>(t.set) * dim + d];
      set = (set - v[static_cast<std::size_t>(t.row) * dim + d]) / t.factor;
    }
  loose_ = loose_halves();
  for (const double m : mass) inverse_mass_.push_back(1.0 / m);
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
  load_at(time);
  for (const Load& load : loads_)
    for (std::size_t k = 0; k < load.force.size(); ++k)
      f[static_cast<std::size_t>(load.drive->components[k])] -= load.force[k];
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
  for (std::size_t k = 0; k < held.size(); ++k) held_[k] = held_force[static_cast<std::size_t>(held[k])];
  load_at(time);
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
  for (std::size_t row = 0; row < inverse_mass_.size(); ++row)
    for (std::size_t d = 0; d < Dim; ++d) f[row * Dim + d] *= -inverse_mass_[row];
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
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      const std::size_t row = static_cast<std::size_t>(t.row) * dim + d;
      double& set = f[static_cast<std::size_t>(t.set) * dim + d];
      set = (set - (system.held[row] ? 0.0 : f[row])) / t.factor;
    }
  for (const Index c : system.prescribed.components) f[static_cast<std::size_t>(c)] = 0.0;
}

void MovingSystem::let_go(std::span<const field::ForceLoss> losses, std::span<double> a)
{
  const auto& held = system.prescribed.components;
  for (const field::ForceLoss& loss : losses)
    if (system.held[static_cast<std::size_t>(loss.component)])
      held_[static_cast<std::size_t>(std::ranges::find(held, loss.component) - held.begin())] -= loss.force;
    else if (ties_.empty())
      a[static_cast<std::size_t>(loss.component)] +=
          inverse_mass_[static_cast<std::size_t>(loss.component / system.rows.dim)] * loss.force;
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
}

void MovingSystem::move_velocity(double time, double* velocity) const
{
  overwrite(system.drives, rate, time, velocity);
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
}

std::array<double, 3> MovingSystem::momentum(std::span<const double> velocity) const
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  std::vector<double> inertia(velocity.size(), 0.0);
  add_inertia(velocity, inertia);
  std::array<double, 3> sum{};
  const auto sets = static_cast<std::size_t>(system.rows.nodes),
             particles = sets + static_cast<std::size_t>(system.rows.enriched);
  for (std::size_t row = 0; row < mass.size(); ++row) // all rows move alike where the body does, and no set opens
    for (std::size_t d = 0; d < dim && (row < sets || row >= particles); ++d) sum[d] += inertia[row * dim + d];
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, system.rows.comm);
  return sum;
}

namespace {
/// Adds m v.v and m a.a of rows begin ... end, in sums that do not wait for each other.
template <std::size_t Dim>
void add_weighed_squares(std::span<const double> mass, const double* v, const double* a, std::size_t begin,
                         std::size_t end, double& vv, double& aa)
{
  constexpr std::size_t abreast = 4;
  Lanes<2> of_v[abreast] = {}, of_a[abreast] = {};
  const auto square = [](const double* x) {
    Lanes<2> xx = load<2>(x) * load<2>(x);
    if constexpr (Dim == 3) xx[0] += x[2] * x[2];
    return xx;
  };
  const auto add = [&](std::size_t row, std::size_t to) {
    of_v[to] += mass[row] * square(v + row * Dim);
    of_a[to] += mass[row] * square(a + row * Dim);
  };
  std::size_t row = begin;
  for (; row + abreast <= end; row += abreast)
    for (std::size_t k = 0; k < abreast; ++k) add(row + k, k);
  for (; row < end; ++row) add(row, 0);
  const Lanes<2> sum_v = (of_v[0] + of_v[1]) + (of_v[2] + of_v[3]), sum_a = (of_a[0] + of_a[1]) + (of_a[2] + of_a[3]);
  vv += sum_v[0] + sum_v[1];
  aa += sum_a[0] + sum_a[1];
}
} // namespace

/// m v.v of all rows, m a.a of all, m v.v of particles.
template <std::size_t Dim> void MovingSystem::add_squares(std::span<const double> a, double (&sums)[3]) const
{
  const auto particles = static_cast<std::size_t>(system.rows.first_particle());
  add_weighed_squares<Dim>(mass, v.data(), a.data(), 0, particles, sums[0], sums[1]);
  add_weighed_squares<Dim>(mass, v.data(), a.data(), particles, mass.size(), sums[2], sums[1]);
  sums[0] += sums[2];
}

KineticEnergy MovingSystem::kinetic_energy(std::span<const double> a, double step) const
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  double sums[3] = {0.0, 0.0, 0.0};
  dim == 2 ? add_squares<2>(a, sums) : add_squares<3>(a, sums);
  for (const field::Tie& t : ties_)
    for (std::size_t d = 0; d < dim; ++d) {
      const std::size_t i = static_cast<std::size_t>(t.row) * dim + d, s = static_cast<std::size_t>(t.set) * dim + d;
      const double m = mass[static_cast<std::size_t>(t.set)], far = v[i] + t.factor * v[s], af = a[i] + t.factor * a[s];
      sums[0] += m * (far * far - v[s] * v[s]);
      sums[1] += m * (af * af - a[s] * a[s]);
    }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, system.rows.comm);
  return {0.5 * sums[0], 0.5 * sums[2], step * step / 8.0 * sums[1]};
}

std::array<double, 3> MovingSystem::fastest_place() const
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  struct {
    double speed;
    int rank;
  } fastest{-1.0, 0};
  MPI_Comm_rank(system.rows.comm, &fastest.rank);
  std::array<double, 3> place{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const double speed = std::isnan(v[i]) ? std::numeric_limits<double>::infinity() : std::abs(v[i]);
    if (speed <= fastest.speed) continue;
    fastest.speed = speed;
    for (std::size_t d = 0; d < dim; ++d) place[d] = system.coordinates[i / dim * dim + d];
  }
  MPI_Allreduce(MPI_IN_PLACE, &fastest, 1, MPI_DOUBLE_INT, MPI_MAXLOC, system.rows.comm);
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, fastest.rank, system.rows.comm);
  return place;
}
} // namespace pdx::solve
