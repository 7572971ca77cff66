#pragma once
#include "lattice_units.hpp"
#include "pdx/track/tracker.hpp"

#include <optional>

namespace pdx::track {
/// What parts the particles of a cell.
struct Parted {
  Bodies bodies; ///< of the cell and a horizon around it
  Line line;     ///< between the two that are more than crumbs
};

/// The line with the best margin between the two bodies of a cell and a horizon around it, from that through midpoints
/// of nearest pairs on (total least squares). None if there is one body, or more than two, or if the crack turns back.
/// @param start   in spacings; what lies behind it counts if it lies on the right sides of the line without it
/// @param heading unit vector, the sense of the line
/// @param tracker what says where the line is
std::optional<Parted> parted(const BondGraph& graph, const CellBox& cell, const Line& start, const Vector<2>& heading,
                             Tracker tracker);

/// Do the bodies lie on different sides of the line, in the cell and to one spacing?
bool parts_along(const BondGraph& graph, const Bodies& bodies, const CellBox& cell, const Line& line);
} // namespace pdx::track
