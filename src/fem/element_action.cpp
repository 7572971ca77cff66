#include "pdx/fem/element_action.hpp"

#include "pdx/base/widest.hpp"

#include <cstddef>

namespace pdx::fem {
namespace {
/// f = sum over columns j of K_j u_j: the columns stay in registers, each u_j is spread over the lanes.
PDX_WIDEST void act(const double* stiffness, const std::array<Index, 4>* elements, std::size_t count, const double* x,
                    double* y)
{
  for (std::size_t e = 0; e < count; ++e) {
    const std::array<Index, 4>& rows = elements[e];
    double f[8] = {};
    for (std::size_t a = 0; a < 4; ++a) {
      const double* u = x + 2 * static_cast<std::ptrdiff_t>(rows[a]);
      const double* k = stiffness + 16 * a;
      for (std::size_t i = 0; i < 8; ++i) f[i] += k[i] * u[0] + k[8 + i] * u[1];
    }
    for (std::size_t a = 0; a < 4; ++a) {
      double* to = y + 2 * static_cast<std::ptrdiff_t>(rows[a]);
      to[0] += f[2 * a];
      to[1] += f[2 * a + 1];
    }
  }
}
} // namespace

void add_element_action(std::span<const double, 64> stiffness, std::span<const std::array<Index, 4>> elements,
                        const double* x, double* y)
{
  act(stiffness.data(), elements.data(), elements.size(), x, y);
}
} // namespace pdx::fem
