#include "parted_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace pdx::xfem {
namespace {
constexpr double kRounding = 1e-12; // of a cell: what is nearer to a crack is on it
constexpr double kStarClear = 1e-9; // of a cell, that a place where cracks meet keeps from its border
constexpr double kInside = 1e-4;    // of the crack it ends on, that an end keeps from the border of the cell

double cross_product(const Vector<2>& a, const Vector<2>& b) { return a.x() * b.y() - a.y() * b.x(); }

int next_corner(int corner) { return (corner + 1) % 4; }

/// Distance of x from the segment between a and b.
double distance_from(const Vector<2>& x, const Vector<2>& a, const Vector<2>& b)
{
  const Vector<2> along = b - a;
  const double squared = along.squaredNorm();
  const double t = squared > 0.0 ? std::clamp((x - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (x - a - t * along).norm();
}

double distance_from(const Vector<2>& x, const geom::Polygon& outline)
{
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outline.size(); ++k)
    least = std::min(least, distance_from(x, outline[k], outline[(k + 1) % outline.size()]));
  return least;
}

/// Length that two outlines run along each other.
double shared_length(const geom::Polygon& a, const geom::Polygon& b, double tiny)
{
  double length = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vector<2>&from = a[i], &to = a[(i + 1) % a.size()];
    const double size = (to - from).norm();
    if (size <= tiny) continue;
    const Vector<2> along = (to - from) / size;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vector<2>&p = b[j], &q = b[(j + 1) % b.size()];
      if (std::abs(cross_product(along, p - from)) > tiny || std::abs(cross_product(along, q - from)) > tiny) continue;
      const auto [low, high] = std::minmax(along.dot(p - from), along.dot(q - from));
      length += std::max(0.0, std::min(high, size) - std::max(low, 0.0));
    }
  }
  return length;
}
} // namespace

std::optional<Side> CellPart::side_of_crack(int crack) const
{
  for (const auto& [number, side] : sides)
    if (number == crack) return side;
  return std::nullopt;
}

PartedCell::PartedCell(Index cell, const fem::Corners& corners, std::span<const PieceCut> cuts)
    : cell_(cell), corners_(corners), cuts_(cuts.begin(), cuts.end()), parts_(1)
{
  double reach = 0.0;
  for (const Vector<2>& x : corners) reach = std::max(reach, x.cwiseAbs().maxCoeff());
  tiny_ = kRounding * (corners[2] - corners[0]).norm() + 4.0 * std::numeric_limits<double>::epsilon() * reach;
  parts_[0].outline.assign(corners.begin(), corners.end());
  std::vector<const PieceCut*> ends;
  for (const PieceCut& cut : cuts_) {
    for (int edge = 0; edge < 4; ++edge) {
      const double a = cut.distance[static_cast<std::size_t>(edge)];
      const double b = cut.distance[static_cast<std::size_t>(next_corner(edge))];
      if (side_of(a) != side_of(b) && (cut.entry < 0 || cut.entry == edge))
        crossings_[static_cast<std::size_t>(edge)].push_back(a / (a - b));
    }
    if (cut.entry >= 0)
      ends.push_back(&cut);
    else if (cut.snapped)
      parts_[0].sides.emplace_back(cut.crack, *cut.snapped);
  }
  for (std::vector<double>& all : crossings_) std::ranges::sort(all);
  if (star(ends)) return;
  for (const PieceCut& cut : cuts_)
    if (cut.entry < 0 && !cut.snapped) run_through(cut);
  for (bool any = true; any && !ends.empty();) {
    const auto before = ends.size();
    std::erase_if(ends, [&](const PieceCut* cut) { return end_on(*cut); });
    any = ends.size() < before || pair(ends);
  }
}

Vector<2> PartedCell::on_edge(int edge, double fraction) const
{
  const Vector<2>&a = corners_[static_cast<std::size_t>(edge)],
        &b = corners_[static_cast<std::size_t>(next_corner(edge))];
  return a + fraction * (b - a);
}

Vector<2> PartedCell::crossing_of(const PieceCut& cut, int edge) const
{
  const double a = cut.distance[static_cast<std::size_t>(edge)];
  return on_edge(edge, a / (a - cut.distance[static_cast<std::size_t>(next_corner(edge))]));
}

Side PartedCell::side_on_edge(const PieceCut& cut, int edge, double fraction) const
{
  const double a = cut.distance[static_cast<std::size_t>(edge)];
  const double b = cut.distance[static_cast<std::size_t>(next_corner(edge))];
  return xfem::side_of(a + fraction * (b - a));
}

const PartedCell::Chord* PartedCell::chord_of(int crack) const
{
  const auto at = std::ranges::find(chords_, crack, &Chord::crack);
  return at == chords_.end() ? nullptr : &*at;
}

/// Divides parts along a chord, all of them or those on one side of another crack.
void PartedCell::divide(const Chord& chord, const Vector<2>& to_plus, const std::pair<int, Side>* within)
{
  Vector<2> normal = Vector<2>(chord.from.y() - chord.to.y(), chord.to.x() - chord.from.x()).normalized();
  if (normal.dot(to_plus) < 0.0) normal = -normal;
  std::vector<CellPart> divided;
  for (CellPart& part : parts_) {
    if (within && part.side_of_crack(within->first) != within->second) {
      divided.push_back(std::move(part));
      continue;
    }
    std::vector<double> distance;
    for (const Vector<2>& x : part.outline) {
      const double d = normal.dot(x - chord.from);
      distance.push_back(std::abs(d) <= tiny_ ? 0.0 : d);
    }
    geom::Split halves = geom::split(part.outline, distance);
    for (const Side side : kSides) {
      geom::Polygon& outline = side == Side::plus ? halves.plus : halves.minus;
      if (outline.empty()) continue;
      divided.push_back({std::move(outline), part.sides, -1, -1});
      divided.back().sides.emplace_back(chord.crack, side);
    }
  }
  parts_ = std::move(divided);
}

void PartedCell::run_through(const PieceCut& cut)
{
  std::vector<int> edges;
  for (int edge = 0; edge < 4; ++edge)
    if (side_on_edge(cut, edge, 0.0) != side_on_edge(cut, edge, 1.0)) edges.push_back(edge);
  if (edges.size() < 2) return;
  const Vector<2> along = on_edge(edges[0], 1.0) - on_edge(edges[0], 0.0);
  chords_.push_back({cut.crack, crossing_of(cut, edges[0]), crossing_of(cut, edges[1])});
  const Vector<2> to_plus = side_on_edge(cut, edges[0], 1.0) == Side::plus ? along : Vector<2>(-along);
  divide(Chord(chords_.back()), to_plus, nullptr);
}

/// False: the crack that it ends on is not there yet.
bool PartedCell::end_on(const PieceCut& cut)
{
  const Vector<2> from = crossing_of(cut, cut.entry);
  const Vector<2> along = on_edge(cut.entry, 1.0) - on_edge(cut.entry, 0.0);
  const Vector<2> to_plus = side_on_edge(cut, cut.entry, 1.0) == Side::plus ? along : Vector<2>(-along);
  const auto host = std::ranges::find(cuts_, cut.other, &PieceCut::crack);
  if (host != cuts_.end() && host->snapped) { // the end lies on the border of the cell
    const double at = (from - on_edge(cut.entry, 0.0)).norm() / along.norm();
    if (side_on_edge(*host, cut.entry, at) == *host->snapped && (cut.end - from).norm() > tiny_) {
      chords_.push_back({cut.crack, from, cut.end});
      divide(Chord(chords_.back()), to_plus, nullptr);
    }
    return true;
  }
  const Chord* other = chord_of(cut.other);
  if (!other) return false;
  const Chord line = *other;
  const Vector<2> ahead = cut.end - from, of_other = line.to - line.from;
  const double across = cross_product(ahead, of_other);
  double at = 0.5; // of the other, where they meet
  if (std::abs(across) > 0.0) at = cross_product(ahead, from - line.from) / across;
  if (!(at >= kInside && at <= 1.0 - kInside)) at = std::isfinite(at) ? std::clamp(at, kInside, 1.0 - kInside) : 0.5;
  chords_.push_back({cut.crack, from, line.from + at * of_other});
  std::optional<Side> side;
  double least = std::numeric_limits<double>::infinity();
  for (const CellPart& part : parts_) // the one that has the place where it comes in
    if (const double away = distance_from(from, part.outline); away < least) {
      least = away;
      side = part.side_of_crack(cut.other);
    }
  if (!side) return true;
  const std::pair<int, Side> within{cut.other, *side};
  divide(Chord(chords_.back()), to_plus, &within);
  return true;
}

/// Cracks that meet in one place, and nothing else in the cell: each is straight from there to its edge, so that bent
/// ones are where they are. False: it is something else.
bool PartedCell::star(const std::vector<const PieceCut*>& ends)
{
  if (ends.empty()) return false;
  const Vector<2> middle = ends[0]->end;
  struct Ray {
    int crack;
    Vector<2> along; // unit vector, outwards
    Side left;       // side of the crack to its left
    double angle;
  };
  std::vector<Ray> rays;
  const auto add = [&](const PieceCut& cut, int edge) {
    const Vector<2> along = (crossing_of(cut, edge) - middle).normalized();
    const Vector<2> of_edge = on_edge(edge, 1.0) - on_edge(edge, 0.0);
    const bool plus_ahead = side_on_edge(cut, edge, 1.0) == Side::plus;
    const bool plus_left = (cross_product(along, of_edge) > 0.0) == plus_ahead;
    rays.push_back({cut.crack, along, plus_left ? Side::plus : Side::minus, std::atan2(along.y(), along.x())});
  };
  const double clear = kStarClear * (corners_[2] - corners_[0]).norm();
  for (int edge = 0; edge < 4; ++edge) {
    const Vector<2> from = on_edge(edge, 0.0), along = (on_edge(edge, 1.0) - from).normalized();
    if (cross_product(along, middle - from) < clear) return false;
  }
  for (const PieceCut& cut : cuts_) {
    if (cut.snapped) return false;
    if (cut.entry >= 0) {
      if ((cut.end - middle).norm() > tiny_) return false;
      add(cut, cut.entry);
      continue;
    }
    if (cut.crack != ends[0]->other) return false;
    for (int edge = 0; edge < 4; ++edge)
      if (side_on_edge(cut, edge, 0.0) != side_on_edge(cut, edge, 1.0)) add(cut, edge);
  }
  std::ranges::sort(rays, {}, &Ray::angle);
  parts_.clear();
  const geom::Polygon whole(corners_.begin(), corners_.end());
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const Ray &ray = rays[k], &next = rays[(k + 1) % rays.size()];
    const double wide = next.angle - ray.angle + (k + 1 == rays.size() ? 2.0 * std::numbers::pi : 0.0);
    std::vector<Vector<2>> along{ray.along};
    if (wide > std::numbers::pi) along.emplace_back(std::cos(ray.angle + 0.5 * wide), std::sin(ray.angle + 0.5 * wide));
    along.push_back(next.along);
    const auto first = static_cast<int>(parts_.size());
    for (std::size_t j = 0; j + 1 < along.size(); ++j) {
      CellPart part;
      part.outline = left_of(left_of(whole, middle, along[j]), middle, -along[j + 1]);
      if (part.outline.empty()) continue;
      if (static_cast<int>(parts_.size()) > first) part.joined_to = first;
      part.sides = {{ray.crack, ray.left}};
      if (next.crack != ray.crack) part.sides.emplace_back(next.crack, opposite(next.left));
      parts_.push_back(std::move(part));
    }
  }
  return true;
}

geom::Polygon PartedCell::left_of(const geom::Polygon& outline, const Vector<2>& from, const Vector<2>& along) const
{
  std::vector<double> distance;
  for (const Vector<2>& x : outline) {
    const double d = cross_product(along, x - from);
    distance.push_back(std::abs(d) <= tiny_ ? 0.0 : d);
  }
  return outline.empty() ? outline : geom::split(outline, distance).plus;
}

/// Cracks that end on each other, none of which runs through: the two that are straightest are one.
bool PartedCell::pair(std::vector<const PieceCut*>& ends)
{
  double straightest = std::numeric_limits<double>::infinity();
  std::pair<const PieceCut*, const PieceCut*> best{nullptr, nullptr};
  for (const PieceCut* a : ends)
    for (const PieceCut* b : ends) {
      if (a->crack >= b->crack || (a->other != b->crack && b->other != a->crack && (a->end - b->end).norm() > tiny_))
        continue;
      const Vector<2> one = (crossing_of(*a, a->entry) - a->end).normalized();
      const Vector<2> two = (crossing_of(*b, b->entry) - b->end).normalized();
      if (one.dot(two) >= straightest) continue;
      straightest = one.dot(two);
      best = {a, b};
    }
  if (!best.first) return false;
  const PieceCut *const a = best.first, *const b = best.second;
  const Vector<2> along = on_edge(a->entry, 1.0) - on_edge(a->entry, 0.0);
  const Chord chord{a->crack, crossing_of(*a, a->entry), crossing_of(*b, b->entry)};
  divide(chord, side_on_edge(*a, a->entry, 1.0) == Side::plus ? along : Vector<2>(-along), nullptr);
  const Vector<2> of_b = on_edge(b->entry, 1.0) - on_edge(b->entry, 0.0);
  const Vector<2> to_plus_of_b = side_on_edge(*b, b->entry, 1.0) == Side::plus ? of_b : Vector<2>(-of_b);
  const Vector<2> to_plus_of_a = side_on_edge(*a, a->entry, 1.0) == Side::plus ? along : Vector<2>(-along);
  const Vector<2> normal(chord.from.y() - chord.to.y(), chord.to.x() - chord.from.x());
  const bool alike = (normal.dot(to_plus_of_a) > 0.0) == (normal.dot(to_plus_of_b) > 0.0);
  for (CellPart& part : parts_) {
    const Side side = *part.side_of_crack(a->crack);
    part.sides.emplace_back(b->crack, alike ? side : opposite(side));
  }
  chords_.push_back(chord);
  chords_.push_back({b->crack, chord.from, chord.to});
  std::erase_if(ends, [&](const PieceCut* cut) { return cut == a || cut == b; });
  return true;
}

int PartedCell::owner_at(int edge, double fraction) const
{
  const Vector<2> x = on_edge(edge, fraction);
  int owner = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < parts_.size(); ++k)
    if (const double away = distance_from(x, parts_[k].outline); away < least) {
      least = away;
      owner = static_cast<int>(k);
    }
  while (parts_[static_cast<std::size_t>(owner)].joined_to >= 0)
    owner = parts_[static_cast<std::size_t>(owner)].joined_to;
  return owner;
}

int PartedCell::part_at(int edge, double fraction) const
{
  for (const PieceCut& cut : cuts_)
    if (cut.snapped && side_on_edge(cut, edge, fraction) != *cut.snapped) return -1;
  const int owner = owner_at(edge, fraction);
  return parts_[static_cast<std::size_t>(owner)].taken_by < 0 ? owner : -1;
}

int PartedCell::mover_of(int part) const
{
  while (!parts_[static_cast<std::size_t>(part)].is_own()) {
    const CellPart& here = parts_[static_cast<std::size_t>(part)];
    part = here.joined_to >= 0 ? here.joined_to : here.taken_by;
  }
  return part;
}

int PartedCell::neighbour_of(int part) const
{
  int best = -1;
  double longest = -1.0;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (static_cast<int>(k) == part || !parts_[k].is_own()) continue;
    const double length =
        shared_length(parts_[static_cast<std::size_t>(part)].outline, parts_[k].outline, 10.0 * tiny_);
    if (length <= longest) continue;
    longest = length;
    best = static_cast<int>(k);
  }
  return best;
}
} // namespace pdx::xfem
