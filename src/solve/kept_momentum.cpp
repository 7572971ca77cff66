#include "pdx/solve/kept_momentum.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/base/symmetric.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
constexpr double kNoInertia = 1e-12; // of the largest: a line does not turn about itself

/// All but sets.
std::vector<std::size_t> movable(const field::Rows& rows, std::span<const Index> of)
{
  std::vector<std::size_t> some;
  for (const Index row : of)
    if (row < rows.nodes || row >= rows.first_particle()) some.push_back(static_cast<std::size_t>(row));
  return some;
}
} // namespace

void keep_momentum(const MovingSystem& moving, std::span<const Index> is_new, const std::array<double, 3>& wanted,
                   std::span<double> v)
{
  const field::Rows& rows = moving.system.rows;
  const auto dim = static_cast<std::size_t>(rows.dim);
  const std::vector<std::size_t> more = movable(rows, is_new); // rows that may take it, as one velocity
  std::array<double, 3> mass{};
  if (any_rank(rows.comm, !moving.ties().empty())) {
    std::vector<double> all(v.size(), 0.0);
    for (const std::size_t row : more) std::fill_n(all.begin() + static_cast<std::ptrdiff_t>(row * dim), dim, 1.0);
    mass = moving.momentum(all);
  } else {
    for (const std::size_t row : more)
      for (std::size_t d = 0; d < dim; ++d) mass[d] += moving.mass[row];
    MPI_Allreduce(MPI_IN_PLACE, mass.data(), 3, MPI_DOUBLE, MPI_SUM, rows.comm);
  }
  const std::array<double, 3> now = moving.momentum(v);
  if (mass[0] <= 0.0) return;
  for (const std::size_t row : more)
    for (std::size_t d = 0; d < dim; ++d) v[row * dim + d] += (wanted[d] - now[d]) / mass[d];
}

namespace {
/// With zeros behind what the plane has not.
Vector<3> at(std::span<const double> values, std::size_t row, std::size_t dim)
{
  Vector<3> x = Vector<3>::Zero();
  for (std::size_t d = 0; d < dim; ++d) x[static_cast<Eigen::Index>(d)] = values[dim * row + d];
  return x;
}
} // namespace

Vector<3> angular_momentum(const MovingSystem& moving, std::span<const double> u, std::span<const double> v)
{
  const field::Rows& rows = moving.system.rows;
  const auto dim = static_cast<std::size_t>(rows.dim);
  const std::vector<double>& place = moving.system.coordinates;
  Vector<3> sum = Vector<3>::Zero();
  const auto add = [&](double mass, const Vector<3>& x, const Vector<3>& of) { sum += mass * x.cross(of); };
  std::vector<bool> tied(moving.mass.size(), false);
  for (const field::Tie& t : moving.ties()) { // far halves
    const auto set = static_cast<std::size_t>(t.set), row = static_cast<std::size_t>(t.row);
    tied[set] = true;
    add(moving.mass[set], at(place, row, dim) + at(u, row, dim) + t.factor * at(u, set, dim),
        at(v, row, dim) + t.factor * at(v, set, dim));
  }
  for (std::size_t row = 0; row < moving.mass.size(); ++row)
    if (!tied[row]) add(moving.mass[row], at(place, row, dim) + at(u, row, dim), at(v, row, dim));
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_DOUBLE, MPI_SUM, rows.comm);
  return sum;
}

void keep_angular_momentum(const MovingSystem& moving, std::span<const Index> is_new, const Vector<3>& wanted,
                           std::span<const double> u, std::span<double> v)
{
  const field::Rows& rows = moving.system.rows;
  const auto dim = static_cast<std::size_t>(rows.dim);
  const field::System& system = moving.system;
  if (any_rank(rows.comm, !system.prescribed.components.empty() || !system.rollers.empty())) return;
  const std::vector<std::size_t> turns = movable(rows, is_new);
  std::vector<double> drift(v.size(), 0.0); // as one velocity
  for (const std::size_t row : turns) std::fill_n(drift.begin() + static_cast<std::ptrdiff_t>(dim * row), dim, 1.0);
  const std::array<double, 3> mass = moving.momentum(drift);
  if (mass[0] <= 0.0) return;
  // A turn about each axis, about their middle, and what angular momentum it has.
  const Eigen::Index first = dim == 2 ? 2 : 0;
  std::array<std::vector<double>, 3> turn;
  Tensor<3> inertia = Tensor<3>::Identity();
  for (Eigen::Index axis = first; axis < 3; ++axis) {
    std::vector<double>& of = turn[static_cast<std::size_t>(axis)];
    of.assign(v.size(), 0.0);
    for (const std::size_t row : turns) {
      const Vector<3> speed = Vector<3>::Unit(axis).cross(at(moving.system.coordinates, row, dim) + at(u, row, dim));
      for (std::size_t d = 0; d < dim; ++d) of[dim * row + d] = speed[static_cast<Eigen::Index>(d)];
    }
    const std::array<double, 3> off = moving.momentum(of);
    for (std::size_t k = 0; k < v.size(); ++k) of[k] -= drift[k] * off[k % dim] / mass[k % dim];
    inertia.col(axis) = angular_momentum(moving, u, of);
  }
  const Vector<3> missing = wanted - angular_momentum(moving, u, v);
  Vector<3> rate = Vector<3>::Zero();
  if (dim == 2) {
    if (inertia(2, 2) <= 0.0) return;
    rate[2] = missing[2] / inertia(2, 2);
  } else
    rate = least_solution(inertia, missing, kNoInertia);
  for (Eigen::Index axis = first; axis < 3; ++axis)
    for (std::size_t k = 0; k < v.size(); ++k) v[k] += rate[axis] * turn[static_cast<std::size_t>(axis)][k];
}
} // namespace pdx::solve
