#include "pdx/fem/stress_recovery.hpp"

#include "pdx/fem/elastic_kernel.hpp"

namespace pdx::fem {
Eigen::Matrix<double, 3, 4> corner_stress(const Corners& corners, const ElementVector& displacement,
                                          const law::Elastic& law, Kinematics kinematics, const field::FreeStrain* free)
{
  const Gradients points = gauss_points();
  Eigen::Matrix<double, 3, 4> at_points, at_corners;
  for (int g = 0; g < 4; ++g) {
    const PointStrain p = point_strain(map_point(corners, points.col(g)).gradients, displacement, kinematics);
    at_points.col(g) = cauchy_stress(p, law, kinematics);
    if (free)
      at_points.col(g).head<2>().array() -= law.swelling_stress((*free)(place_of(corners, shape(points.col(g)))));
  }
  // In coordinates scaled so that the Gauss points are at +-1, the corners are at +-sqrt(3).
  for (int a = 0; a < 4; ++a) at_corners.col(a) = at_points * shape(std::numbers::sqrt3 * reference_corners().col(a));
  return at_corners;
}

std::vector<double> nodal_stress(const ElasticBody& body, std::span<const double> displacement,
                                 const field::FreeStrain* free)
{
  const mesh::Mesh& mesh = body.mesh;
  const auto owned = static_cast<std::size_t>(mesh.owned_vertices());
  std::vector<double> stress(3 * owned, 0.0);
  std::vector<int> cells(owned, 0);
  for (Index c = 0; c < mesh.cells(); ++c) {
    if (mesh.use(c) == mesh::Use::cut || mesh.use(c) == mesh::Use::points) continue;
    const auto& vertices = mesh.cell(c);
    ElementVector d;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto v = static_cast<std::size_t>(vertices[a]);
      d.segment<2>(static_cast<Index>(2 * a)) << displacement[2 * v], displacement[2 * v + 1];
    }
    const auto at_corners = corner_stress(mesh.corners(c), d, body.law_of(c), body.kinematics, free);
    for (std::size_t a = 0; a < 4; ++a) {
      const auto v = static_cast<std::size_t>(vertices[a]);
      if (v >= owned) continue;
      for (int i = 0; i < 3; ++i) stress[3 * v + static_cast<std::size_t>(i)] += at_corners(i, static_cast<Index>(a));
      ++cells[v];
    }
  }
  for (std::size_t v = 0; v < owned; ++v)
    for (std::size_t i = 0; i < 3; ++i) stress[3 * v + i] /= std::max(1, cells[v]);
  return stress;
}
} // namespace pdx::fem
