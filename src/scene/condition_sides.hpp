#pragma once
#include "pdx/options/scene_options.hpp"

namespace pdx::scene {
/// A side of a box: across which axis, and at which end.
struct BoxSide {
  std::size_t axis;
  bool high;
};

/// The side of that name in so many dimensions: left, right (x), bottom, top (y), back, front (z). None: no such side.
std::optional<BoxSide> box_side(const std::string& name, std::size_t dim);

/// That of bodies of points. Throws UserError for another name.
BoxSide point_side(const options::BoundaryCondition& c, std::size_t dim);

/// A side of a body of points is one of nodes only where lines of the grid are: throws UserError for one that is so
/// many cells away from a line. @param width of a cell [m]
void require_line(const options::BoundaryCondition& c, const std::string& body, double cells, double width);
} // namespace pdx::scene
