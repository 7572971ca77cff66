#include "pdx/solve/kept_momentum.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>

namespace pdx::solve {
void keep_momentum(const MovingSystem& moving, std::span<const double> is_new, const std::array<double, 3>& wanted,
                   std::vector<double>& v)
{
  const field::Rows& rows = moving.system.rows;
  const auto dim = static_cast<std::size_t>(rows.dim);
  std::vector<std::size_t> more; // rows that may take it, as one velocity
  for (std::size_t row = 0; row < is_new.size(); ++row)
    if (is_new[row] != 0.0 &&
        (static_cast<Index>(row) < rows.nodes || static_cast<Index>(row) >= rows.first_particle()))
      more.push_back(row);
  std::array<double, 3> mass{};
  if (any_rank(rows.comm, !moving.ties().empty())) {
    std::vector<double> all(v.size(), 0.0);
    for (const std::size_t row : more)
      std::fill_n(all.begin() + static_cast<std::ptrdiff_t>(row * dim), dim, is_new[row]);
    mass = moving.momentum(all);
  } else {
    for (const std::size_t row : more)
      for (std::size_t d = 0; d < dim; ++d) mass[d] += moving.mass[row] * is_new[row];
    MPI_Allreduce(MPI_IN_PLACE, mass.data(), 3, MPI_DOUBLE, MPI_SUM, rows.comm);
  }
  const std::array<double, 3> now = moving.momentum(v);
  if (mass[0] <= 0.0) return;
  for (const std::size_t row : more)
    for (std::size_t d = 0; d < dim; ++d) v[row * dim + d] += is_new[row] * (wanted[d] - now[d]) / mass[d];
}

double angular_momentum(const MovingSystem& moving, std::span<const double> u, std::span<const double> v)
{
  const field::Rows& rows = moving.system.rows;
  const std::vector<double>& place = moving.system.coordinates;
  double sum = 0.0;
  const auto add = [&](double mass, const Vector<2>& x, const Vector<2>& of) {
    sum += mass * (x[0] * of[1] - x[1] * of[0]);
  };
  const auto at = [](std::span<const double> values, std::size_t row) {
    return Vector<2>(values[2 * row], values[2 * row + 1]);
  };
  std::vector<bool> tied(moving.mass.size(), false);
  for (const field::Tie& t : moving.ties()) { // far halves
    const auto set = static_cast<std::size_t>(t.set), row = static_cast<std::size_t>(t.row);
    tied[set] = true;
    add(moving.mass[set], at(place, row) + at(u, row) + t.factor * at(u, set), at(v, row) + t.factor * at(v, set));
  }
  for (std::size_t row = 0; row < moving.mass.size(); ++row)
    if (!tied[row]) add(moving.mass[row], at(place, row) + at(u, row), at(v, row));
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, rows.comm);
  return sum;
}

void keep_angular_momentum(const MovingSystem& moving, std::span<const double> is_new, double wanted,
                           std::span<const double> u, std::vector<double>& v)
{
  const field::Rows& rows = moving.system.rows;
  if (rows.dim != 2 || any_rank(rows.comm, !moving.system.prescribed.components.empty())) return;
  std::vector<double> drift(v.size(), 0.0), turn(v.size(), 0.0); // as one velocity, as one turn
  for (std::size_t row = 0; row < is_new.size(); ++row) {
    const bool moves = static_cast<Index>(row) < rows.nodes || static_cast<Index>(row) >= rows.first_particle();
    if (!moves || is_new[row] == 0.0) continue;
    drift[2 * row] = drift[2 * row + 1] = 1.0;
    turn[2 * row] = -moving.system.coordinates[2 * row + 1] - u[2 * row + 1];
    turn[2 * row + 1] = moving.system.coordinates[2 * row] + u[2 * row];
  }
  const std::array<double, 3> mass = moving.momentum(drift), off = moving.momentum(turn);
  if (mass[0] <= 0.0) return;
  for (std::size_t k = 0; k < v.size(); ++k) turn[k] -= drift[k] * off[k % 2] / mass[k % 2]; // about their middle
  const double inertia = angular_momentum(moving, u, turn), missing = wanted - angular_momentum(moving, u, v);
  if (inertia <= 0.0) return;
  for (std::size_t k = 0; k < v.size(); ++k) v[k] += missing / inertia * turn[k];
}
} // namespace pdx::solve
