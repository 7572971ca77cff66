#pragma once
#include "pdx/base/tensor.hpp"

#include <array>
#include <vector>

namespace pdx::law {
/// Temperatures on a grid of times and places; straight between its points, and beyond its ends as there.
struct TemperatureTable {
  std::array<std::vector<double>, 3> axes; ///< times [s], x, y [m]; ascending, one value or more each
  std::vector<double> values;              ///< time by time, in it x by x, in it y by y             [K]

  double at(const Vector<2>& x, double time) const;
};
} // namespace pdx::law
