#include "pdx/xfem/loads.hpp"

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

/// Part of an edge, as fractions of it from its first corner.
struct EdgePart {
  Side side;
  double begin, end;
};

std::array<EdgePart, 2> parts_of(const CutElement& cut, std::size_t first, std::size_t last)
{
  const double a = cut.distance[first], b = cut.distance[last];
  const Side at_first = cut.snapped.value_or(side_of(a)), at_last = cut.snapped.value_or(side_of(b));
  const double middle = at_first == at_last ? 1.0 : a / (a - b);
  return {{{at_first, 0.0, middle}, {at_last, middle, 1.0}}};
}

/// A piece lies on the plus side of its element; what of the edge between two corners is its own, from the first.
std::vector<EdgePart> edge_parts(const CutElement& cut, std::size_t first, std::size_t last)
{
  std::vector<EdgePart> parts;
  if (!cut.piece) {
    const auto both = parts_of(cut, first, last);
    return {both.begin(), both.end()};
  }
  for (const EdgeShare& share : cut.piece->edges) {
    const auto edge = static_cast<std::size_t>(share.edge), next = (edge + 1) % 4;
    if (edge == first && next == last) parts.push_back({Side::plus, share.begin, share.end});
    if (edge == last && next == first) parts.push_back({Side::plus, 1.0 - share.end, 1.0 - share.begin});
  }
  return parts;
}

std::size_t corner_of(const mesh::Mesh& mesh, Index cell, Index vertex)
{
  return static_cast<std::size_t>(std::ranges::find(mesh.cell(cell), vertex) - mesh.cell(cell).begin());
}
} // namespace

void add_traction(const mesh::Mesh& mesh, const EnrichedSets& sets, std::span<const mesh::BoundaryEdge> edges,
                  const Vector<2>& traction, const fem::Thickness& thickness, const fem::NodalForces& target)
{
  for (const mesh::BoundaryEdge& edge : edges) {
    if (!sets.cut(edge.cell)) continue;
    const std::size_t first = corner_of(mesh, edge.cell, edge.vertices[0]);
    const std::size_t last = corner_of(mesh, edge.cell, edge.vertices[1]);
    const double length = (mesh.point(edge.vertices[1]) - mesh.point(edge.vertices[0])).norm();
    const Vector<2> force = length * thickness(edge.cell) * traction; // of the whole edge
    for (const CutElement& cut : sets.all_of(edge.cell))
      for (const EdgePart& part : edge_parts(cut, first, last)) {
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
