#include "pdx/base/lanes.hpp"
#include "pdx/solve/moving_system.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace pdx::solve {
std::array<double, 3> MovingSystem::momentum(std::span<const double> velocity) const
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  std::array<double, 3> sum{};
  if (ties_.empty()) {
    for (std::size_t row = 0; row < mass.size(); ++row)
      for (std::size_t d = 0; d < dim; ++d) sum[d] += mass[row] * velocity[row * dim + d];
    MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, system.rows.comm);
    return sum;
  }
  std::vector<double> inertia(velocity.size(), 0.0);
  add_inertia(velocity, inertia);
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
