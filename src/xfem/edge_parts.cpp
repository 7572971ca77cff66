#include "pdx/xfem/edge_parts.hpp"

#include <algorithm>

namespace pdx::xfem {
namespace {
constexpr double kSome = 1e-6;       // of an edge: more than a crack through a node is off it by
constexpr double kClearAlong = 0.01; // of an edge: more than places are rounded by

std::array<EdgePart, 2> parts_of_whole(const CutElement& cut, std::size_t first, std::size_t last)
{
  const double a = cut.distance[first], b = cut.distance[last];
  const Side at_first = cut.snapped.value_or(side_of(a)), at_last = cut.snapped.value_or(side_of(b));
  const double middle = at_first == at_last ? 1.0 : a / (a - b);
  return {{{at_first, 0.0, middle}, {at_last, middle, 1.0}}};
}
} // namespace

std::array<std::size_t, 2> corners_of(const mesh::Mesh& mesh, const mesh::BoundaryEdge& edge)
{
  const auto& cell = mesh.cell(edge.cell);
  const auto of = [&](Index v) { return static_cast<std::size_t>(std::ranges::find(cell, v) - cell.begin()); };
  return {of(edge.vertices[0]), of(edge.vertices[1])};
}

std::vector<EdgePart> edge_parts(const mesh::Mesh& mesh, const CutElement& cut, const mesh::BoundaryEdge& edge)
{
  const auto [first, last] = corners_of(mesh, edge);
  if (!cut.piece) {
    const auto both = parts_of_whole(cut, first, last);
    return {both.begin(), both.end()};
  }
  std::vector<EdgePart> parts;
  for (const EdgeShare& share : cut.piece->edges) { // a piece is all on the plus side
    const auto from = static_cast<std::size_t>(share.edge), to = (from + 1) % 4;
    if (from == first && to == last) parts.push_back({Side::plus, share.begin, share.end});
    if (from == last && to == first) parts.push_back({Side::plus, 1.0 - share.end, 1.0 - share.begin});
  }
  return parts;
}

std::optional<Vector<2>> far_half_on(const mesh::Mesh& mesh, const EnrichedSets& sets, const mesh::BoundaryEdge& edge,
                                     Index vertex, const EnrichedSet& set)
{
  const bool is_first = edge.vertices[0] == vertex;
  const std::size_t corner = corners_of(mesh, edge)[is_first ? 0 : 1];
  double begin = 1.0, place = 1.0; // fractions of the edge, from the vertex
  for (const CutElement& cut : sets.all_of(edge.cell)) {
    if (cut.sets[corner] != set.row) continue;
    for (const EdgePart& part : edge_parts(mesh, cut, edge)) {
      if (part.end - part.begin <= kSome || set_factor(cut, corner, part.side) == 0.0) continue;
      const double from = is_first ? part.begin : 1.0 - part.end;
      if (from >= begin) continue;
      begin = from;
      place = from + std::min(kClearAlong, 0.5 * (part.end - part.begin));
    }
  }
  if (begin >= 1.0 - kSome) return std::nullopt;
  const Vector<2>&at = mesh.point(vertex), &other = mesh.point(edge.vertices[is_first ? 1 : 0]);
  return Vector<2>(at + place * (other - at));
}
} // namespace pdx::xfem
