#pragma once
#include "pdx/base/tensor.hpp"

#include <Eigen/LU>
#include <numbers>

namespace pdx::fem {
/// Corners of a four-node cell, counter-clockwise [m].
using Corners = std::array<Vector<2>, 4>;
/// Gradients of the four shape functions, one column per corner.
using Gradients = Eigen::Matrix<double, 2, 4>;

/// Corners of the reference square [-1, 1]^2, counter-clockwise, one per column.
inline Gradients reference_corners() { return Gradients{{-1.0, 1.0, 1.0, -1.0}, {-1.0, -1.0, 1.0, 1.0}}; }

/// The 2 x 2 Gauss points of the reference square, in the order of the corners they are next to; each has weight 1.
inline Gradients gauss_points() { return reference_corners() * std::numbers::inv_sqrt3; }

/// N_a = (1 + xi xi_a)(1 + eta eta_a) / 4 at a point of the reference square.
inline Eigen::Vector4d shape(const Vector<2>& xi)
{
  const Gradients corner = reference_corners();
  return 0.25 * (1.0 + xi.x() * corner.row(0).array()) * (1.0 + xi.y() * corner.row(1).array());
}

/// Where a point of a cell with these N_a is [m].
inline Vector<2> place_of(const Corners& corners, const Eigen::Vector4d& shape)
{
  Vector<2> x = Vector<2>::Zero();
  for (int a = 0; a < 4; ++a) x += shape[a] * corners[static_cast<std::size_t>(a)];
  return x;
}

/// dN_a / d(xi, eta) at a point of the reference square.
inline Gradients reference_gradients(const Vector<2>& xi)
{
  const Gradients corner = reference_corners();
  Gradients g;
  g.row(0) = 0.25 * corner.row(0).array() * (1.0 + xi.y() * corner.row(1).array());
  g.row(1) = 0.25 * corner.row(1).array() * (1.0 + xi.x() * corner.row(0).array());
  return g;
}

/// A point of a cell, seen in space.
struct CellPoint {
  Gradients gradients; ///< dN_a / dx [1/m]
  double jacobian;     ///< area in space per area of the reference square [m^2]
};

/// Maps a point of the reference square; the cell must be convex and counter-clockwise (jacobian above 0).
inline CellPoint map_point(const Corners& corners, const Vector<2>& xi)
{
  const Gradients g = reference_gradients(xi);
  Tensor<2> dx_dxi = Tensor<2>::Zero();
  for (int a = 0; a < 4; ++a) dx_dxi += corners[static_cast<std::size_t>(a)] * g.col(a).transpose();
  return {dx_dxi.inverse().transpose() * g, dx_dxi.determinant()};
}

/// A point at which a cell, or a part of one, is integrated.
struct QuadraturePoint {
  Gradients gradients; ///< dN_a / dx [1/m]
  double area;         ///< its weight [m^2]
};

/// The 2 x 2 Gauss points of a whole cell, in the order of the corners they are next to.
inline std::array<QuadraturePoint, 4> gauss_rule(const Corners& corners)
{
  std::array<QuadraturePoint, 4> rule;
  const Gradients points = gauss_points();
  for (int g = 0; g < 4; ++g) {
    const CellPoint at = map_point(corners, points.col(g));
    rule[static_cast<std::size_t>(g)] = {at.gradients, at.jacobian};
  }
  return rule;
}
} // namespace pdx::fem
