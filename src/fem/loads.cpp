#include "pdx/fem/loads.hpp"

#include "pdx/fem/shape.hpp"

namespace pdx::fem {
namespace {
void add_at(Index vertex, const Vector<2>& force, const NodalForces& target)
{
  const PetscInt row = target.node_rows[static_cast<std::size_t>(vertex)];
  if (!target.rows.owns(row)) return;
  const auto at = 2 * static_cast<std::size_t>(row - target.rows.first);
  target.force[at] += force.x();
  target.force[at + 1] += force.y();
}
} // namespace

void add_traction(const mesh::Mesh& mesh, std::span<const mesh::BoundaryEdge> edges, const Vector<2>& traction,
                  const Thickness& thickness, const NodalForces& target)
{
  for (const mesh::BoundaryEdge& edge : edges) {
    if (const mesh::Use use = mesh.use(edge.cell); use != mesh::Use::plain && use != mesh::Use::points) continue;
    const double length = (mesh.point(edge.vertices[1]) - mesh.point(edge.vertices[0])).norm();
    for (const Index v : edge.vertices) add_at(v, 0.5 * length * thickness(edge.cell) * traction, target);
  }
}

void add_body_force(const mesh::Mesh& mesh, const BodyForce& body_force, const Thickness& thickness,
                    const NodalForces& target)
{
  const Gradients points = gauss_points();
  for (const Index c : mesh.cells(mesh::Use::plain)) {
    const Corners corners = mesh.corners(c);
    std::array<Vector<2>, 4> force;
    force.fill(Vector<2>::Zero());
    for (int g = 0; g < 4; ++g) {
      const Eigen::Vector4d n = shape(points.col(g));
      Vector<2> x = Vector<2>::Zero();
      for (int a = 0; a < 4; ++a) x += n[a] * corners[static_cast<std::size_t>(a)];
      const Vector<2> share = map_point(corners, points.col(g)).jacobian * thickness(c) * body_force(x);
      for (int a = 0; a < 4; ++a) force[static_cast<std::size_t>(a)] += n[a] * share;
    }
    for (std::size_t a = 0; a < 4; ++a) add_at(mesh.cell(c)[a], force[a], target);
  }
}
} // namespace pdx::fem
