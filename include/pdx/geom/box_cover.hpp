#pragma once
#include "pdx/geom/box.hpp"

#include <vector>

namespace pdx::geom {
/// What of a box lies outside another: at most four boxes. What is no wider than `near` [m] is nothing.
std::vector<Box<2>> without(const Box<2>& box, const Box<2>& hole, double near);

/// Boxes that have a whole side in common, to `near` [m], become one, until no two have; they stay in the order of
/// their first parts.
std::vector<Box<2>> joined(std::vector<Box<2>> boxes, double near);
} // namespace pdx::geom
