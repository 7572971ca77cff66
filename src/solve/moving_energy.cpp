#include "pdx/base/lanes.hpp"
#include "pdx/solve/moving_system.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pdx::solve {
std::vector<std::array<Index, 2>> MovingSystem::counted() const
{
  return counted_.value_or(std::vector<std::array<Index, 2>>{{0, system.rows.owned()}});
}

std::array<double, 3> MovingSystem::momentum(std::span<const double> velocity) const
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  const std::array<Index, 2> sets{system.rows.nodes, system.rows.first_particle()};
  std::array<double, 3> sum{};
  const auto add = [&](Index first, Index end) {
    for (auto row = static_cast<std::size_t>(first); first < end && row < static_cast<std::size_t>(end); ++row)
      for (std::size_t d = 0; d < dim; ++d) sum[d] += mass[row] * velocity[row * dim + d];
  };
  for (const auto& [first, end] : counted()) { // all rows move alike where the body does, and no set opens
    add(first, std::min(end, sets[0]));
    add(std::max(first, sets[1]), end);
  }
  for (const field::Tie& t : ties_) {
    const auto row = static_cast<std::size_t>(t.row), set = static_cast<std::size_t>(t.set);
    for (std::size_t d = 0; d < dim; ++d)
      sum[d] += mass[set] * (velocity[row * dim + d] + t.factor * velocity[set * dim + d]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, system.rows.comm);
  return sum;
}

namespace {
/// Adds m v.v and m a.a of rows begin ... end, in sums that do not wait for each other.
/// @tparam Both false: a is not looked at
template <std::size_t Dim, bool Both>
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
    if constexpr (Both) of_a[to] += mass[row] * square(a + row * Dim);
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
  const Index particles = system.rows.first_particle();
  for (const auto& [first, end] : counted()) {
    const auto add = [&, this](Index from, Index to, double& vv) {
      if (from >= to) return;
      const auto squares = a.empty() ? add_weighed_squares<Dim, false> : add_weighed_squares<Dim, true>;
      squares(mass, v.data(), a.data(), static_cast<std::size_t>(from), static_cast<std::size_t>(to), vv, sums[1]);
    };
    add(first, std::min(end, particles), sums[0]);
    add(std::max(first, particles), end, sums[2]);
  }
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
      const double m = mass[static_cast<std::size_t>(t.set)], far = v[i] + t.factor * v[s];
      sums[0] += m * (far * far - v[s] * v[s]);
      if (a.empty()) continue;
      const double af = a[i] + t.factor * a[s];
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
