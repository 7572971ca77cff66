#pragma once
#include <cstddef>

namespace pdx::solve {
/// y += A x of a dense matrix, row by row, `columns` entries each. In the widest version this processor runs.
void add_dense_product(const double* a, std::size_t rows, std::size_t columns, const double* x, double* y);
} // namespace pdx::solve
