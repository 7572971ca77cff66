#pragma once
#include "pdx/geom/polygon.hpp"

#include <cstdint>
#include <map>
#include <utility>

namespace pdx::xfem {
/// A point of a plane graph in a convex cell.
struct FacePoint {
  int name;           ///< of the caller's
  Vector<2> at;       ///< [m]
  std::uint8_t edges; ///< bit k: it lies on edge k of the cell, whatever rounding says
};

/// What walls leave of a cell: faces, which hang together inside it. Walls that part nothing are in them.
struct CellFaces {
  /// Of each face: convex polygons that make it up, counter-clockwise, by the points' numbers.
  std::vector<std::vector<std::vector<int>>> polygons;
  /// The face to the left of a line of the graph, from point to point.
  std::map<std::pair<int, int>, int> left_of;
};

/// Divides a convex cell into triangles that keep its border and its walls as edges, joins them where no wall is, and
/// makes convex polygons of them. All decisions are signs of exact determinants and comparisons of names: the same
/// for the same points.
/// @param points those of the border first, counter-clockwise   @param border how many those are
/// @param walls between points, by their numbers; they meet in points only, and none is on the border
CellFaces faces_of(const std::vector<FacePoint>& points, int border, const std::vector<std::pair<int, int>>& walls);
} // namespace pdx::xfem
