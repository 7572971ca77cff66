#pragma once
#include "pdx/base/tensor.hpp"

namespace pdx::geom {
/// Which side of the line from a to b the point c is on: +1 left, -1 right, 0 exactly on it. The sign of
/// (b - a) x (c - a) without any rounding: plain arithmetic where its error bound allows, else the six products as an
/// exact sum of doubles (Shewchuk, Discrete Comput. Geom. 18, 1997). Exact while products of coordinates neither
/// overflow nor fall below 1e-290.                                                       [-]
int orientation(const Vector<2>& a, const Vector<2>& b, const Vector<2>& c);
} // namespace pdx::geom
