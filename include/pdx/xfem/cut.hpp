#pragma once
#include "pdx/fem/shape.hpp"
#include "pdx/geom/polygon.hpp"
#include "pdx/xfem/heaviside.hpp"

#include <span>
#include <vector>

namespace pdx::xfem {
/// How a cut cell is integrated. polygons: the part on either side of the crack is cut out and integrated on its own;
/// exact for the force, tangent and energy of parallelograms (polynomials up to degree 4 in space), for other convex
/// cells up to the smooth error of a rule of degree 4. grid: equal sub-cells of the reference square, each with one
/// point at its centre that counts for the side it lies on [XPD1 section 2.2]; its error falls like 1 / sub-cells.
enum class Quadrature { polygons, grid };

/// Sub-cells of `Quadrature::grid` per direction [XPD1 section 2.2: 32 x 32].
constexpr int kGridSubcells = 32;

/// Signed distances of the four corners from a crack that is straight inside the cell [m].
using CornerDistances = std::array<double, 4>;

/// A point of a cut cell.
struct PartPoint : fem::QuadraturePoint {
  Eigen::Vector4d shape; ///< N_a [-]
};

/// Quadrature points of a cell, by side of the crack. Reference geometry only.
struct CutCell {
  std::array<std::vector<PartPoint>, 2> parts; ///< minus, plus

  std::span<const PartPoint> points(Side side) const { return parts[static_cast<std::size_t>(side)]; }
};

/// Cuts a convex cell along the line between its corners of either sign.
/// @param corners counter-clockwise [m]   @param subcells per direction, for the grid only
CutCell cut_cell(const fem::Corners& corners, const CornerDistances& distance, Quadrature quadrature,
                 int subcells = kGridSubcells);

/// Adds the points of a convex part of a cell to a side.
void add_part_points(const fem::Corners& corners, const geom::Polygon& part, Side side, CutCell& cell);

/// A cell that lies on one side as a whole, with the 2 x 2 Gauss points of a plain element.
CutCell whole_cell(const fem::Corners& corners, Side side);

/// Area of a convex cell on either side of the crack as the quadrature sees it; exact for polygons.
SideAreas side_areas(const fem::Corners& corners, const CornerDistances& distance, Quadrature quadrature);
} // namespace pdx::xfem
