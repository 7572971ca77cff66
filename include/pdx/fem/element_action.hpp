#pragma once
#include "pdx/base/tensor.hpp"

#include <array>
#include <span>

namespace pdx::fem {
/// y += K x over elements of one shape, without a matrix: K is the 8 x 8 stiffness all of them share (symmetric,
/// row-major) [N/m], each element names the rows of its four nodes, x and y hold two components per row.
/// Picks the widest vector instructions the processor has.
void add_element_action(std::span<const double, 64> stiffness, std::span<const std::array<Index, 4>> elements,
                        const double* x, double* y);
} // namespace pdx::fem
