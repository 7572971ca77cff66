#pragma once
#include "pdx/base/tensor.hpp"

namespace pdx::mesh {
/// True if a convex cell holds x. Exactly one cell of a conforming mesh holds any interior point, also one on an edge
/// or a vertex, whichever rank asks: x is shifted by `tolerance` [m] up and to the right (so that points meant to lie
/// on an edge all fall to the same side in spite of rounding), and the side of the shifted point is found exactly,
/// ties broken by a further symbolic shift (e, e^2). Hence points within about `tolerance` of the right or upper rim
/// of the domain may be held by no cell.
/// @param corners counter-clockwise [m]   @param natural natural vertex numbers of the corners
bool cell_holds(const std::array<Vector<2>, 4>& corners, const std::array<Index, 4>& natural, const Vector<2>& x,
                double tolerance);

/// Weights of the corners in the bilinear map at x; they sum to 1 and reproduce x. Exact for parallelograms; x may lie
/// outside, near the cell.
/// @param corners counter-clockwise [m]   @param x [m]
std::array<double, 4> bilinear_weights(const std::array<Vector<2>, 4>& corners, const Vector<2>& x);
} // namespace pdx::mesh
