#include "pdx/law/temperature_table.hpp"

#include <algorithm>

namespace pdx::law {
namespace temperature_table {
struct Between {
  std::size_t low, high;
  double share; // of high
};

Between find(const std::vector<double>& axis, double value)
{
  const auto above = static_cast<std::size_t>(std::ranges::upper_bound(axis, value) - axis.begin());
  if (above == 0) return {0, 0, 0.0};
  if (above == axis.size()) return {above - 1, above - 1, 0.0};
  return {above - 1, above, (value - axis[above - 1]) / (axis[above] - axis[above - 1])};
}
} // namespace temperature_table

double TemperatureTable::at(const Vector<2>& x, double time) const
{
  using namespace temperature_table;
  const Between t = find(axes[0], time), a = find(axes[1], x[0]), b = find(axes[2], x[1]);
  const auto value = [&](std::size_t i, std::size_t j, std::size_t k) {
    return values[(i * axes[1].size() + j) * axes[2].size() + k];
  };
  const auto mix = [](double low, double high, double share) { return low + share * (high - low); };
  const auto along_y = [&](std::size_t i, std::size_t j) {
    return mix(value(i, j, b.low), value(i, j, b.high), b.share);
  };
  const auto along_x = [&](std::size_t i) { return mix(along_y(i, a.low), along_y(i, a.high), a.share); };
  return mix(along_x(t.low), along_x(t.high), t.share);
}
} // namespace pdx::law
