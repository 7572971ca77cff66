#include "pdx/xfem/cut.hpp"

#include "pdx/mesh/locate.hpp"

namespace pdx::xfem {
namespace {
/// Where a point of the cell lies in the reference square.
Vector<2> reference_point(const fem::Corners& corners, const Vector<2>& x)
{
  const std::array<double, 4> weights = mesh::bilinear_weights(corners, x);
  return fem::reference_corners() * Eigen::Map<const Eigen::Vector4d>(weights.data());
}

std::vector<PartPoint> polygon_points(const fem::Corners& corners, const geom::Polygon& part)
{
  std::vector<PartPoint> points;
  for (const auto& [x, weight] : geom::quadrature(part)) {
    const Vector<2> xi = reference_point(corners, x);
    points.push_back({{fem::map_point(corners, xi).gradients, weight}, fem::shape(xi)});
  }
  return points;
}

CutCell cut_by_polygons(const fem::Corners& corners, const CornerDistances& distance)
{
  const auto [minus, plus] = geom::split(corners, distance);
  return {{polygon_points(corners, minus), polygon_points(corners, plus)}};
}

CutCell cut_by_grid(const fem::Corners& corners, const CornerDistances& distance, int subcells)
{
  CutCell cell;
  const double side = 2.0 / subcells; // of a sub-cell in the reference square
  for (int j = 0; j < subcells; ++j)
    for (int i = 0; i < subcells; ++i) {
      const Vector<2> xi((i + 0.5) * side - 1.0, (j + 0.5) * side - 1.0);
      const fem::CellPoint at = fem::map_point(corners, xi);
      const Eigen::Vector4d shape = fem::shape(xi);
      const double here = shape.dot(Eigen::Map<const Eigen::Vector4d>(distance.data()));
      cell.parts[static_cast<std::size_t>(side_of(here))].push_back({{at.gradients, at.jacobian * side * side}, shape});
    }
  return cell;
}
} // namespace

CutCell cut_cell(const fem::Corners& corners, const CornerDistances& distance, Quadrature quadrature, int subcells)
{
  return quadrature == Quadrature::grid ? cut_by_grid(corners, distance, subcells) : cut_by_polygons(corners, distance);
}

void add_part_points(const fem::Corners& corners, const geom::Polygon& part, Side side, CutCell& cell)
{
  const std::vector<PartPoint> points = polygon_points(corners, part);
  std::vector<PartPoint>& all = cell.parts[static_cast<std::size_t>(side)];
  all.insert(all.end(), points.begin(), points.end());
}

CutCell whole_cell(const fem::Corners& corners, Side side)
{
  CutCell cell;
  const fem::Gradients points = fem::gauss_points();
  for (int g = 0; const fem::QuadraturePoint& at : fem::gauss_rule(corners))
    cell.parts[static_cast<std::size_t>(side)].push_back({at, fem::shape(points.col(g++))});
  return cell;
}

SideAreas side_areas(const fem::Corners& corners, const CornerDistances& distance, Quadrature quadrature)
{
  SideAreas areas;
  if (quadrature == Quadrature::grid) {
    const CutCell cell = cut_by_grid(corners, distance, kGridSubcells);
    for (const Side side : kSides)
      for (const PartPoint& at : cell.points(side)) areas[side] += at.area;
  } else {
    const auto [minus, plus] = geom::split(corners, distance);
    areas = {{geom::area(minus), geom::area(plus)}};
  }
  return areas;
}
} // namespace pdx::xfem
