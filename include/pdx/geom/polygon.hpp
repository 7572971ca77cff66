#pragma once
#include "pdx/base/tensor.hpp"

#include <span>
#include <vector>

namespace pdx::geom {
/// Corners of a convex polygon, counter-clockwise [m]; empty if it has no area.
using Polygon = std::vector<Vector<2>>;

/// Area, above 0 if counter-clockwise.                                            [m^2]
double area(std::span<const Vector<2>> corners);

/// The two parts of a convex polygon on either side of a line.
struct Split {
  Polygon minus; ///< where the distance is below 0
  Polygon plus;  ///< where it is above 0
};

/// Cuts a convex polygon along the line where the linear function with the values `distance` at the corners is 0.
/// A corner at distance 0 belongs to both parts; a part that is a point or an edge is empty.
/// @param corners counter-clockwise [m]   @param distance one value per corner, signed [m]
Split split(std::span<const Vector<2>> corners, std::span<const double> distance);

/// A point of a quadrature rule.
struct WeightedPoint {
  Vector<2> point; ///< [m]
  double weight;   ///< [m^2]
};

/// Points that integrate polynomials up to degree 4 exactly over a convex polygon: a fan of triangles with six points
/// each, all inside, weights above 0 [Dunavant 1985, "High degree efficient symmetrical Gaussian quadrature rules for
/// the triangle", degree 4]. None for a polygon without area.
std::vector<WeightedPoint> quadrature(std::span<const Vector<2>> corners);
} // namespace pdx::geom
