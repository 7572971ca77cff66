#include "parted_cells.hpp"

#include "cell_faces.hpp"
#include "plane.hpp"

#include <algorithm>

namespace pdx::xfem {
namespace {
/// A place well inside a part.
Vector<2> place_in(const CellPart& part)
{
  return middle_of(
      *std::ranges::max_element(part.outlines, {}, [](const auto& outline) { return geom::area(outline); }));
}
} // namespace

std::optional<Side> CellPart::side_of_crack(int crack) const
{
  for (const auto& [number, side] : sides)
    if (number == crack) return side;
  return std::nullopt;
}

PartedCell::PartedCell(const CrackNet& net, std::size_t number, Index cell, const fem::Corners& corners,
                       std::span<const PieceCut> cuts, const crack::CrackSet& cracks, bool obey_snaps)
    : cell_(cell), cuts_(cuts.begin(), cuts.end())
{
  const auto is_snapped = [&](int crack) {
    const auto cut = std::ranges::find(cuts_, crack, &PieceCut::crack);
    return obey_snaps && cut != cuts_.end() && cut->snapped.has_value();
  };
  std::vector<FacePoint> points;
  std::map<int, int> number_of; // by vertex of the net
  const auto add = [&](int vertex, std::uint8_t edges) {
    const auto [at, fresh] = number_of.try_emplace(vertex, static_cast<int>(points.size()));
    if (fresh) points.push_back({vertex, net.point(vertex), 0});
    points[static_cast<std::size_t>(at->second)].edges |= edges;
  };
  const std::vector<NetShare> border = net.border(number);
  for (const NetShare& share : border) add(share.from, static_cast<std::uint8_t>(1u << share.edge));
  for (const NetShare& share : border) add(share.to, static_cast<std::uint8_t>(1u << share.edge));
  const auto on_border = static_cast<int>(points.size());
  std::vector<std::pair<int, int>> lines;
  std::vector<const NetWall*> walls;
  for (const NetWall& wall : net.walls(number)) {
    if (std::ranges::all_of(wall.cracks, is_snapped)) continue;
    add(wall.from, 0);
    add(wall.to, 0);
    lines.emplace_back(number_of.at(wall.from), number_of.at(wall.to));
    walls.push_back(&wall);
  }

  std::vector<std::set<int>> bounding(1);
  if (lines.empty()) {
    parts_.push_back({{geom::Polygon(corners.begin(), corners.end())}, geom::area(corners), {}, -1});
    for (const NetShare& share : border) border_.push_back({share, 0, true});
  } else {
    const CellFaces faces = faces_of(points, on_border, lines);
    bounding.resize(faces.polygons.size());
    for (const std::vector<std::vector<int>>& face : faces.polygons) {
      CellPart& part = parts_.emplace_back();
      for (const std::vector<int>& outline : face) {
        geom::Polygon& polygon = part.outlines.emplace_back();
        for (const int k : outline) polygon.push_back(points[static_cast<std::size_t>(k)].at);
        part.area += geom::area(polygon);
      }
    }
    if (parts_.size() == 1) parts_[0] = {{geom::Polygon(corners.begin(), corners.end())}, geom::area(corners), {}, -1};
    for (const NetShare& share : border)
      border_.push_back({share, faces.left_of.at({number_of.at(share.from), number_of.at(share.to)}), true});
    for (std::size_t k = 0; k < walls.size(); ++k) {
      const auto [a, b] = lines[k];
      const int left = faces.left_of.at({a, b}), right = faces.left_of.at({b, a});
      if (left == right) continue;
      shared_[std::minmax(left, right)] += (net.point(walls[k]->to) - net.point(walls[k]->from)).norm();
      parting_.insert(walls[k]->cracks.begin(), walls[k]->cracks.end());
      for (const int part : {left, right})
        bounding[static_cast<std::size_t>(part)].insert(walls[k]->cracks.begin(), walls[k]->cracks.end());
    }
  }
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    std::set<int> beside = bounding[p];
    for (const PieceCut& cut : cuts_) beside.insert(cut.crack);
    for (const int crack : beside) {
      const auto cut = std::ranges::find(cuts_, crack, &PieceCut::crack);
      parts_[p].sides.emplace_back(crack, is_snapped(crack) ? *cut->snapped
                                                            : side_of(cracks.side(crack, place_in(parts_[p]))));
    }
  }
  for (const PieceCut& cut : cuts_)
    if (is_snapped(cut.crack))
      for (Share& share : border_) {
        const Vector<2> middle = 0.5 * (net.point(share.from) + net.point(share.to));
        share.held = share.held && side_of(cracks.side(cut.crack, middle)) == *cut.snapped;
      }
}

int PartedCell::mover_of(int part) const
{
  while (parts_[static_cast<std::size_t>(part)].taken_by >= 0) part = parts_[static_cast<std::size_t>(part)].taken_by;
  return part;
}

int PartedCell::neighbour_of(int part, const std::vector<int>& among) const
{
  int best = -1;
  double longest = 0.0;
  for (const int other : among) {
    const auto shared = shared_.find(std::minmax(part, other));
    if (shared == shared_.end() || shared->second <= longest) continue;
    longest = shared->second;
    best = other;
  }
  return best;
}
} // namespace pdx::xfem
