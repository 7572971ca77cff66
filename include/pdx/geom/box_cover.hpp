#pragma once
#include "pdx/geom/box.hpp"

#include <span>
#include <vector>

namespace pdx::geom {
/// Do two boxes overlap, or share a side or a corner, to `near` [m]?
bool touch(const Box<2>& a, const Box<2>& b, double near);

/// Does one of the boxes hold x, a border included to a millionth of its smaller side?
bool hold(std::span<const Box<2>> boxes, const Vector<2>& x);

/// The first of the boxes that holds all of another, a border included likewise; 0 where none does.
Index holder(std::span<const Box<2>> boxes, const Box<2>& box);

/// What of a box lies outside another: at most four boxes. What is no wider than `near` [m] is nothing.
std::vector<Box<2>> without(const Box<2>& box, const Box<2>& hole, double near);

/// Boxes that have a whole side in common, to `near` [m], become one, until no two have; they stay in the order of
/// their first parts.
std::vector<Box<2>> joined(std::vector<Box<2>> boxes, double near);
} // namespace pdx::geom
