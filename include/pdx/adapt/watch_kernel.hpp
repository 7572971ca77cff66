#pragma once
#include "pdx/base/processor.hpp"
#include "pdx/base/tensor.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace pdx::adapt {
/// Cells side by side: cell k of a run has its four nodes, counter-clockwise from the lower left, in rows[a] + k.
struct WatchRun {
  std::array<Index, 4> rows{};
  Index cells = 0;
  double along = 0.0, across = 0.0; ///< what makes squares of displacement gradients of squares of differences [1/m^2]
  double limit = 0.0;               ///< least square of a displacement gradient that is suspicious [-]
};

/// The cells whose displacement gradient may be too large, ascending: cell k of all runs in a row. The gradient
/// anywhere in a cell is no more than the root of the larger differences along its opposite edges, squared, scaled and
/// added.
/// @param u displacement of all rows, two each [m]
void find_suspicious(Processor processor, std::span<const WatchRun> runs, std::span<const double> u,
                     std::vector<std::size_t>& found);
} // namespace pdx::adapt
