#include "parted_cells.hpp"
#include "pdx/base/run_of.hpp"
#include "plane.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::xfem {
namespace {
constexpr double kOff = 4.0; // tolerances from the line that distances of corners draw: the crack is elsewhere

using Stretch = std::pair<Vector<2>, Vector<2>>;

/// What of a line lies in a cell grown by `margin` [m].
std::optional<Stretch> stretch_in(const fem::Corners& corners, const Stretch& line, double margin)
{
  double from = 0.0, to = 1.0; // what is not outside of any edge
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector<2> along = (corners[(k + 1) % 4] - corners[k]).normalized();
    const double a = cross_product(along, line.first - corners[k]) + margin;
    const double b = cross_product(along, line.second - corners[k]) + margin;
    if (a < 0.0 && b < 0.0) return std::nullopt;
    if (a < 0.0) from = std::max(from, a / (a - b));
    if (b < 0.0) to = std::min(to, a / (a - b));
  }
  const Vector<2> along = line.second - line.first;
  return from <= to ? std::optional(Stretch(line.first + from * along, line.first + to * along)) : std::nullopt;
}

/// What of a crack lies in a cell grown by `margin` [m].
std::vector<Stretch> stretches_in(const fem::Corners& corners, const crack::Polyline& crack, double margin)
{
  std::vector<Stretch> found;
  for (std::size_t k = 0; k + 1 < crack.size(); ++k)
    if (const auto stretch = stretch_in(corners, {crack[k], crack[k + 1]}, margin)) found.push_back(*stretch);
  return found;
}

/// Is the crack where distances of corners say, all through the cell, and nowhere else in it?
/// @param inside of the crack
bool is_straight(const fem::Corners& corners, const CellCut& cut, std::span<const Stretch> inside,
                 const crack::CrackSet& cracks, double tolerance)
{
  std::vector<Vector<2>> ends;
  for (std::size_t k = 0; k < 4; ++k) {
    const double a = cut.distance[k], b = cut.distance[(k + 1) % 4];
    if (side_of(a) == side_of(b)) continue;
    ends.push_back(corners[k] + a / (a - b) * (corners[(k + 1) % 4] - corners[k]));
    if (std::abs(cracks.signed_distance(cut.crack, ends.back())) > kOff * tolerance) return false;
  }
  if (ends.size() != 2) return false;
  const auto is_off = [&](const Vector<2>& x) {
    return std::abs(cross_product(ends[1] - ends[0], x - ends[0])) > kOff * tolerance * (ends[1] - ends[0]).norm();
  };
  return std::ranges::none_of(inside, [&](const Stretch& one) { return is_off(one.first) || is_off(one.second); });
}
} // namespace

std::vector<Meeting> find_meetings(const MeshView& view, std::span<const NearCell> near, std::span<const CellCut> cuts,
                                   const crack::CrackSet& cracks, double tolerance)
{
  std::vector<Meeting> found;
  for (std::size_t begin = 0, end = 0; begin < near.size(); begin = end) {
    const Index cell = near[begin].cell;
    while (end < near.size() && near[end].cell == cell) ++end;
    const fem::Corners corners = view.corners(cell);
    const auto of_cell = run_of(cuts, cell, &CellCut::cell);
    int reaching = 0;
    bool is_plain = of_cell.size() < 2;
    for (const NearCell& one : near.subspan(begin, end - begin)) {
      const crack::Polyline& crack = cracks.seen(one.crack);
      if (stretches_in(corners, crack, tolerance).empty()) continue;
      ++reaching;
      const std::vector<Stretch> inside = stretches_in(corners, crack, -tolerance);
      const auto cut = std::ranges::find(of_cell, one.crack, &CellCut::crack);
      is_plain =
          is_plain && (cut != of_cell.end() ? is_straight(corners, *cut, inside, cracks, tolerance) : inside.empty());
    }
    if (is_plain && reaching < 2) continue;
    const std::array<std::array<Index, 4>, 1> nodes{{{0, 1, 2, 3}}};
    const std::array<Index, 1> alone{0};
    const CrackNet net({nodes, corners, alone}, cracks, tolerance);
    const PartedCell parted(net, 0, cell, corners, {}, cracks, false);
    if (of_cell.size() > 1 || parted.parting().size() > 1)
      found.push_back({cell, true});
    else if (net.meet_on_border(0) || (!is_plain && !parted.parting().empty()))
      found.push_back({cell, false});
  }
  return found;
}

std::vector<Index> nodes_passed_twice(const MeshView& view, std::span<const CellCut> cuts)
{
  std::map<std::pair<int, Index>, int> far;         // by crack and node: parts across the crack, less what joins them
  std::map<std::array<Index, 3>, int> crossed_from; // by crack and edge, from node to node: cut cells that have it
  for (const CellCut& cut : cuts) {
    const std::array<Index, 4>& nodes = view.cells[static_cast<std::size_t>(cut.cell)];
    for (std::size_t k = 0; k < 4; ++k) {
      int& parts = ++far[{cut.crack, nodes[k]}];
      for (const std::size_t next : {(k + 1) % 4, (k + 3) % 4})
        if (side_of(cut.distance[k]) != side_of(cut.distance[next]))
          parts -= ++crossed_from[{cut.crack, nodes[k], nodes[next]}] == 2;
    }
  }
  std::vector<Index> found;
  for (const auto& [key, parts] : far)
    if (parts > 1) found.push_back(key.second);
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}
} // namespace pdx::xfem
