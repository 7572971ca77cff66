#pragma once
#include "pdx/adapt/divided.hpp"

#include <optional>
#include <span>

namespace pdx::adapt {
/// How much of a full turn around x lies in an element: 1 inside, 1/2 on an edge, a corner's share at the corner, 0
/// outside. Those of all elements add up to 1 for a point inside the body, and to less on its border.
/// @param near what is as near to an edge or corner is on it [m]
double share_of_turn(const Corners& element, const Vector<2>& x, double near);

/// The box of whole elements in which a patch around the tip of a crack begins: those that hold the tip, and layers of
/// elements around them as long as some element of the layer has a node nearer than `reach` to the tip, as expansion
/// would take it [XPD2 Eqs. 10-14]. It ends where the body does, and before elements that the lattice does not divide.
/// Mirrored elements and tip give the mirrored box. Nothing where the elements at the tip are no boxes of whole
/// spacings that make up a box.
/// @param own     elements that hold the tip; the lattice begins at a corner of them
/// @param around  at least all elements that meet the square of half-width `reach` around the tip
/// @param spacing of the lattice [m]
/// @param reach   [m]
std::optional<geom::Box<2>> seed_box(std::span<const Corners> own, std::span<const Corners> around,
                                     const Vector<2>& tip, double spacing, double reach);
} // namespace pdx::adapt
