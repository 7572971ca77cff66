#include "pdx/xfem/loads.hpp"

#include "pdx/xfem/edge_parts.hpp"

namespace pdx::xfem {
namespace {
void add_at(PetscInt row, const Vector<2>& force, const fem::NodalForces& target)
{
  if (row < 0 || !target.rows.owns(row)) return;
  const auto at = 2 * static_cast<std::size_t>(row - target.rows.first);
  target.force[at] += force.x();
  target.force[at + 1] += force.y();
}

/// A force that acts on the corner value of one side: u_i + factor * set.
void add_corner(const mesh::Mesh& mesh, const CutElement& cut, std::size_t a, Side side, const Vector<2>& force,
                const fem::NodalForces& target)
{
  add_at(target.node_rows[static_cast<std::size_t>(mesh.cell(cut.cell)[a])], force, target);
  add_at(cut.sets[a], set_factor(cut, a, side) * force, target);
}
} // namespace

void add_traction(const mesh::Mesh& mesh, const EnrichedSets& sets, std::span<const mesh::BoundaryEdge> edges,
                  const Vector<2>& traction, const fem::Thickness& thickness, const fem::NodalForces& target)
{
  for (const mesh::BoundaryEdge& edge : edges) {
    if (!sets.cut(edge.cell)) continue;
    const auto [first, last] = corners_of(mesh, edge);
    const double length = (mesh.point(edge.vertices[1]) - mesh.point(edge.vertices[0])).norm();
    const Vector<2> force = length * thickness(edge.cell) * traction; // of the whole edge
    for (const CutElement& cut : sets.all_of(edge.cell))
      for (const EdgePart& part : edge_parts(mesh, cut, edge)) {
        const double share = part.end - part.begin;
        const double of_last = 0.5 * share * (part.end + part.begin); // integral of N_last = s
        add_corner(mesh, cut, first, part.side, (share - of_last) * force, target);
        add_corner(mesh, cut, last, part.side, of_last * force, target);
      }
  }
}

void add_body_force(const mesh::Mesh& mesh, const EnrichedSets& sets, const fem::BodyForce& body_force,
                    const fem::Thickness& thickness, const fem::NodalForces& target)
{
  for (const CutElement& cut : sets.cells()) {
    const fem::Corners corners = mesh.corners(cut.cell);
    for (const Side side : kSides)
      for (const PartPoint& at : cut.element.cell.points(side)) {
        Vector<2> x = Vector<2>::Zero();
        for (std::size_t a = 0; a < 4; ++a) x += at.shape[static_cast<Index>(a)] * corners[a];
        const Vector<2> force = at.area * thickness(cut.cell) * body_force(x);
        for (std::size_t a = 0; a < 4; ++a)
          add_corner(mesh, cut, a, side, at.shape[static_cast<Index>(a)] * force, target);
      }
  }
}
} // namespace pdx::xfem
