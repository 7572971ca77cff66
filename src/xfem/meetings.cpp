#include "parted_cells.hpp"
#include "pdx/base/run_of.hpp"
#include "plane.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::xfem {
namespace {
constexpr double kOff = 4.0; // tolerances from the line that distances of corners draw: the crack is elsewhere

/// How far x is inside a cell; below 0 outside [m].
double depth_in(const fem::Corners& corners, const Vector<2>& x)
{
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k)
    least = std::min(least, cross_product((corners[(k + 1) % 4] - corners[k]).normalized(), x - corners[k]));
  return least;
}

/// Is the crack where distances of corners say, all through the cell?
bool is_straight(const fem::Corners& corners, const CellCut& cut, const crack::CrackSet& cracks, double tolerance)
{
  std::vector<Vector<2>> ends;
  for (std::size_t k = 0; k < 4; ++k) {
    const double a = cut.distance[k], b = cut.distance[(k + 1) % 4];
    if (side_of(a) == side_of(b)) continue;
    ends.push_back(corners[k] + a / (a - b) * (corners[(k + 1) % 4] - corners[k]));
    if (std::abs(cracks.signed_distance(cut.crack, ends.back())) > kOff * tolerance) return false;
  }
  if (ends.size() != 2) return false;
  return std::ranges::none_of(cracks.seen(cut.crack), [&](const Vector<2>& x) {
    return depth_in(corners, x) > tolerance &&
           std::abs(cross_product(ends[1] - ends[0], x - ends[0])) > kOff * tolerance * (ends[1] - ends[0]).norm();
  });
}

/// Does any straight part of a crack come as near as the tolerance to a cell?
bool reaches(const fem::Corners& corners, const crack::Polyline& line, double tolerance)
{
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    double from = 0.0, to = 1.0; // what is not outside of any edge
    for (std::size_t e = 0; e < 4; ++e) {
      const Vector<2> along = (corners[(e + 1) % 4] - corners[e]).normalized();
      const double a = cross_product(along, line[k] - corners[e]) + tolerance;
      const double b = cross_product(along, line[k + 1] - corners[e]) + tolerance;
      if (a < 0.0 && b < 0.0) from = 2.0;
      if (a < 0.0 && b >= 0.0) from = std::max(from, a / (a - b));
      if (a >= 0.0 && b < 0.0) to = std::min(to, a / (a - b));
    }
    if (from <= to) return true;
  }
  return false;
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
      if (!reaches(corners, cracks.seen(one.crack), tolerance)) continue;
      ++reaching;
      const auto cut = std::ranges::find(of_cell, one.crack, &CellCut::crack);
      const auto inside = [&](const Vector<2>& x) { return depth_in(corners, x) > tolerance; };
      is_plain = is_plain && (cut != of_cell.end() ? is_straight(corners, *cut, cracks, tolerance)
                                                   : std::ranges::none_of(cracks.seen(one.crack), inside));
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
