#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/geom/lattice.hpp"

#include <array>

namespace pdx::adapt {
/// Those of an element, counter-clockwise [m].
using Corners = std::array<Vector<2>, 4>;

constexpr double kFits = 1e-6; ///< of a spacing, for sides of elements on lines of the lattice
constexpr double kSame = 1e-9; ///< of a distance: what is as far to rounding is judged alike

geom::Box<2> box_around(const Corners& corners);

/// Is an element the box around it, to `near` [m]?
bool is_box(const Corners& corners, double near);

/// Does an element have the sides of whole cells of a lattice?
bool is_divided(const Corners& corners, const geom::Lattice<2>& lattice);
} // namespace pdx::adapt
