#pragma once
#include "lattice_units.hpp"

#include <optional>

namespace pdx::track {
/// What parts the particles of a cell.
struct Parted {
  Bodies bodies; ///< of the cell and a horizon around it
  Line line;     ///< between the two that are more than crumbs
};

/// The line between the two bodies of a cell and a horizon around it: total least squares of midpoints of nearest
/// pairs. None if there is one body, or more than two.
/// @param start   in spacings; what lies behind it is not looked at
/// @param heading unit vector, the sense of the line
std::optional<Parted> parted(const BondGraph& graph, const CellBox& cell, const Line& start, const Vector<2>& heading);

/// Do the bodies lie on different sides of the line through a and b, in the cell and to one spacing?
bool parts_along(const BondGraph& graph, const Bodies& bodies, const CellBox& cell, const Line& line);
} // namespace pdx::track
