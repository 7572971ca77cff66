#include "pdx/scene/touched_cells.hpp"

#include <algorithm>

namespace pdx::scene {
std::vector<std::pair<Index, mesh::Use>> TouchedCells::first_notes() const
{
  std::vector<std::pair<Index, mesh::Use>> notes = cells_;
  std::ranges::stable_sort(notes, {}, [](const auto& note) { return note.first; });
  const auto rest = std::ranges::unique(notes, {}, [](const auto& note) { return note.first; });
  notes.erase(rest.begin(), rest.end());
  return notes;
}

std::vector<Index> TouchedCells::all() const
{
  std::vector<Index> cells;
  for (const auto& [cell, before] : first_notes()) cells.push_back(cell);
  return cells;
}

std::vector<Index> TouchedCells::changed(const mesh::Mesh& mesh) const
{
  std::vector<Index> cells;
  for (const auto& [cell, before] : first_notes())
    if (mesh.use(cell) != before) cells.push_back(cell);
  return cells;
}

namespace {
/// Has the straight line from a to b a point in the box?
bool passes(const geom::Box<2>& box, const Vector<2>& a, const Vector<2>& b)
{
  double from = 0.0, to = 1.0;
  for (int d = 0; d < 2; ++d) {
    const double along = b[d] - a[d];
    if (along == 0.0) {
      if (a[d] < box.lower[d] || a[d] > box.upper[d]) return false;
      continue;
    }
    const double low = (box.lower[d] - a[d]) / along, high = (box.upper[d] - a[d]) / along;
    from = std::max(from, std::min(low, high));
    to = std::min(to, std::max(low, high));
  }
  return from <= to;
}
} // namespace

bool near_cracks(const mesh::Mesh& mesh, std::span<const Index> cells, const crack::CrackSet& cracks)
{
  for (const Index c : cells) {
    const auto x = mesh.corners(c);
    geom::Box<2> box{x[0], x[0]};
    double side = 0.0;
    for (std::size_t a = 0; a < 4; ++a) {
      box.lower = box.lower.cwiseMin(x[a]);
      box.upper = box.upper.cwiseMax(x[a]);
      side = std::max(side, (x[(a + 1) % 4] - x[a]).norm());
    }
    box.lower.array() -= 2.0 * side;
    box.upper.array() += 2.0 * side;
    for (int k = 0; k < cracks.size(); ++k) {
      const auto& line = cracks.points(k);
      for (std::size_t i = 0; i + 1 < line.size(); ++i)
        if (passes(box, line[i], line[i + 1])) return true;
    }
  }
  return false;
}

std::vector<Index> vertices_of(const mesh::Mesh& mesh, std::span<const Index> cells)
{
  std::vector<Index> vertices;
  for (const Index c : cells) vertices.insert(vertices.end(), mesh.cell(c).begin(), mesh.cell(c).end());
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

std::vector<std::array<Index, 2>> ranges_of(std::span<const Index> rows)
{
  std::vector<std::array<Index, 2>> ranges;
  for (const Index row : rows)
    if (ranges.empty() || ranges.back()[1] != row)
      ranges.push_back({row, row + 1});
    else
      ++ranges.back()[1];
  return ranges;
}
} // namespace pdx::scene
