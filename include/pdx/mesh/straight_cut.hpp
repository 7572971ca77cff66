#pragma once
#include "pdx/base/tensor.hpp"

#include <span>
#include <vector>

namespace pdx::mesh {
/// Where cells are and what they weigh, of a whole mesh.
struct PlacedCells {
  std::span<const Vector<2>> middle; ///< [m]
  std::span<const int> weight;       ///< above 0
};

/// Part of every cell by recursive bisection: each piece of the body is cut along the line x or y = constant between
/// two middles that parts its weight as the numbers of parts on either side want, across its longer side; lines that
/// tie are decided by rounded places, so that the same mesh is cut the same way. No part is empty if cells lie on as
/// many lines; else there may be such.
std::vector<int> straight_cut(const PlacedCells& cells, int parts);

/// What a cut costs the busiest part: the weight of all cells in the box around it, its own and others', grown by one
/// cell: a part sweeps lattices in windows, and elements and exchanges cost at its border.
double busiest_window(const PlacedCells& cells, std::span<const int> part, int parts);
} // namespace pdx::mesh
