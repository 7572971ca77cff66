#include "pdx/solve/dense_product.hpp"

#include "pdx/base/widest.hpp"

namespace pdx::solve {
namespace {
constexpr std::size_t kLanes = 16;
} // namespace

/// Four rows at a time share what is read of x; sums in lanes, so that they may stay in registers.
PDX_WIDEST void add_dense_product(const double* a, std::size_t rows, std::size_t columns, const double* x, double* y)
{
  const std::size_t whole = columns / kLanes * kLanes;
  for (std::size_t row = 0; row < rows; row += 4) {
    const std::size_t many = rows - row < 4 ? rows - row : 4;
    const double* from[4];
    for (std::size_t r = 0; r < 4; ++r) from[r] = a + (row + (r < many ? r : 0)) * columns;
    double sums[4][kLanes] = {};
    for (std::size_t c = 0; c < whole; c += kLanes)
      for (std::size_t l = 0; l < kLanes; ++l) {
        const double at = x[c + l];
        for (std::size_t r = 0; r < 4; ++r) sums[r][l] += from[r][c + l] * at;
      }
    for (std::size_t r = 0; r < many; ++r) {
      double sum = 0.0;
      for (std::size_t l = 0; l < kLanes; ++l) sum += sums[r][l];
      for (std::size_t c = whole; c < columns; ++c) sum += from[r][c] * x[c];
      y[row + r] += sum;
    }
  }
}
} // namespace pdx::solve
