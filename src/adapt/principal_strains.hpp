#pragma once
#include "pdx/base/tensor.hpp"

#include <array>
#include <cmath>

namespace pdx::adapt {
/// Larger and smaller principal stretch less 1, of F = I + h: rotations feel nothing.
inline std::array<double, 2> principal_strains(const Tensor<2>& h)
{
  const double a = 1.0 + h(0, 0), b = h(0, 1), c = h(1, 0), d = 1.0 + h(1, 1);
  const double plus = std::hypot(a + d, c - b), minus = std::hypot(a - d, c + b);
  return {0.5 * (plus + minus) - 1.0, 0.5 * (plus - minus) - 1.0};
}
} // namespace pdx::adapt
