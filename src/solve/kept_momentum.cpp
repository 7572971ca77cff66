#include "pdx/solve/kept_momentum.hpp"

#include <algorithm>

namespace pdx::solve {
void keep_momentum(const MovingSystem& moving, std::span<const double> is_new, const std::array<double, 3>& wanted,
                   std::vector<double>& v)
{
  const field::Rows& rows = moving.system.rows;
  const auto dim = static_cast<std::size_t>(rows.dim);
  std::vector<double> more(v.size(), 0.0); // as one velocity
  for (std::size_t row = 0; row < is_new.size(); ++row)
    if (static_cast<Index>(row) < rows.nodes || static_cast<Index>(row) >= rows.first_particle())
      std::fill_n(more.begin() + static_cast<std::ptrdiff_t>(row * dim), dim, is_new[row]);
  const std::array<double, 3> mass = moving.momentum(more), now = moving.momentum(v);
  if (mass[0] <= 0.0) return;
  for (std::size_t k = 0; k < v.size(); ++k) v[k] += more[k] * (wanted[k % dim] - now[k % dim]) / mass[k % dim];
}
} // namespace pdx::solve
