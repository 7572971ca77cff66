#include "pdx/xfem/halves.hpp"

#include <algorithm>
#include <limits>

namespace pdx::xfem {
namespace {
constexpr double kClear = 0.01; // of the shortest edge around: more than places are rounded by

/// Of the cut cells that touch a vertex.
double shortest_edge(const mesh::Mesh& mesh, const EnrichedSets& sets, Index vertex)
{
  double shortest = std::numeric_limits<double>::infinity();
  for (const CutElement& cut : sets.cells()) {
    const auto& cell = mesh.cell(cut.cell);
    if (std::ranges::find(cell, vertex) == cell.end()) continue;
    for (std::size_t k = 0; k < 4; ++k)
      shortest = std::min(shortest, (mesh.point(cell[(k + 1) % 4]) - mesh.point(cell[k])).norm());
  }
  return shortest;
}

/// Unit vector to the left of the piece of a crack nearest to x, and the height of x above its line [m].
struct Above {
  Vector<2> left;
  double height;
};

Above above(const crack::Polyline& points, const Vector<2>& x)
{
  double nearest = std::numeric_limits<double>::infinity();
  Above found{};
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Vector<2> along = points[k + 1] - points[k], from = x - points[k];
    const double t = std::clamp(from.dot(along) / along.squaredNorm(), 0.0, 1.0), away = (from - t * along).norm();
    if (away >= nearest) continue;
    nearest = away;
    found.left = Vector<2>(-along.y(), along.x()).normalized();
    found.height = found.left.dot(from);
  }
  return found;
}
} // namespace

Halves halves_of(const mesh::Mesh& mesh, const EnrichedSets& sets, Index vertex, const EnrichedSet& set)
{
  const Vector<2>& x = mesh.point(vertex);
  if (set.far) return {x, *set.far};
  const auto [left, height] = above(sets.cracks().points(set.crack), x);
  const Vector<2> home = set.side == Side::plus ? left : Vector<2>(-left); // to the node's own side
  const double clear = kClear * shortest_edge(mesh, sets, vertex), away = std::abs(height);
  return {x + std::max(0.0, clear - away) * home, x - (away + clear) * home};
}
} // namespace pdx::xfem
