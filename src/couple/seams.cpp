#include "pdx/couple/seams.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/geom/clip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace pdx::couple {
namespace {
constexpr double kSame = 1e-7;       // of the shortest side: points this near are one
constexpr double kProlong = 1e-3;    // of the body's size, as for cracks
constexpr double kSharpest = -0.9;   // cosine of a turn; sharper ones are no continuation
constexpr double kSameWay = 0.9999;  // cosine between two faces of one seam
using Point = std::array<double, 2>; // [m]

struct Side {
  Index low, high; ///< natural numbers of its ends
  Point a, b;
};

Vector<2> vector(const Point& x) { return {x[0], x[1]}; }

/// All boundary sides of the mesh that the filter lets through, once each, in natural order.
template <class Filter> std::vector<Side> boundary_sides(const mesh::Mesh& mesh, Filter&& wanted)
{
  std::vector<Side> mine;
  for (const std::string& name : mesh.boundary_names())
    for (const mesh::BoundaryEdge& edge : *mesh.boundary(name)) {
      if (edge.cell >= mesh.owned_cells()) continue;
      auto [v, w] = edge.vertices;
      if (mesh.natural_vertex(v) > mesh.natural_vertex(w)) std::swap(v, w);
      const Vector<2>&a = mesh.point(v), &b = mesh.point(w);
      if (wanted(a, b)) mine.push_back({mesh.natural_vertex(v), mesh.natural_vertex(w), {a[0], a[1]}, {b[0], b[1]}});
    }
  std::vector<Side> all = gather_all(mesh.comm(), mine);
  const auto key = [](const Side& side) { return std::pair(side.low, side.high); };
  std::sort(all.begin(), all.end(), [&](const Side& s, const Side& t) { return key(s) < key(t); });
  all.erase(std::unique(all.begin(), all.end(), [&](const Side& s, const Side& t) { return key(s) == key(t); }),
            all.end());
  return all;
}

/// Sides as segments between points, those that differ by rounding made one.
class Segments {
public:
  explicit Segments(std::span<const Side> sides)
  {
    double shortest = std::numeric_limits<double>::infinity();
    for (const Side& side : sides) shortest = std::min(shortest, (vector(side.b) - vector(side.a)).norm());
    merge_points(sides, kSame * shortest);
    for (const Side& side : sides) {
      const auto [low, high] = std::minmax(number_.at(side.a), number_.at(side.b));
      if (low != high) ends_.insert({low, high});
    }
    for (const auto& [a, b] : ends_) {
      leaving_[a].push_back(b);
      leaving_[b].push_back(a);
    }
  }

  const std::set<std::pair<std::size_t, std::size_t>>& ends() const { return ends_; }
  std::size_t number(const Point& x) const { return number_.at(x); }
  const Vector<2>& point(std::size_t k) const { return points_[k]; }
  Vector<2> direction(std::size_t from, std::size_t to) const { return (points_[to] - points_[from]).normalized(); }

  /// The other end of the segment that goes on straightest from `from` through `at`, if any does.
  std::optional<std::size_t> beyond(std::size_t from, std::size_t at) const
  {
    std::optional<std::size_t> best;
    double straightest = kSharpest;
    for (const std::size_t next : leaving_.at(at)) {
      const double cosine = direction(from, at).dot(direction(at, next));
      if (next != from && cosine > straightest) {
        best = next;
        straightest = cosine;
      }
    }
    return best;
  }
  /// All segments at a point go the same way: nothing is parted beyond.
  bool tip(std::size_t at) const
  {
    const std::vector<std::size_t>& ends = leaving_.at(at);
    return std::all_of(ends.begin(), ends.end(),
                       [&](std::size_t end) { return direction(at, ends.front()).dot(direction(at, end)) > kSameWay; });
  }

private:
  void merge_points(std::span<const Side> sides, double near)
  {
    for (const Side& side : sides) number_.try_emplace(side.a), number_.try_emplace(side.b);
    for (auto at = number_.begin(); at != number_.end(); ++at) { // ascending x
      auto same = std::make_reverse_iterator(at);
      while (same != number_.rend() && at->first[0] - same->first[0] <= near &&
             std::abs(at->first[1] - same->first[1]) > near)
        ++same;
      const bool merged = same != number_.rend() && at->first[0] - same->first[0] <= near;
      at->second = merged ? same->second : points_.size();
      if (!merged) points_.push_back(vector(at->first));
    }
  }

  std::map<Point, std::size_t> number_;
  std::vector<Vector<2>> points_;
  std::set<std::pair<std::size_t, std::size_t>> ends_;
  std::map<std::size_t, std::vector<std::size_t>> leaving_; // per point: the other ends
};

/// True for sides that lie along a side of the patch, outwards by no more than rounding, or only touch it as they go on
/// from it outside: not for those that go on from it inside, from a corner where two boxes meet.
bool on_border(const PatchShape& shape, const Vector<2>& a, const Vector<2>& b)
{
  const double near = 1e-6 * shape.lattice.dx;
  const Vector<2> middle = 0.5 * (a + b), margin = Vector<2>::Constant(near);
  const bool inside = std::ranges::any_of(shape.boxes, [&](const geom::Box<2>& box) {
    return geom::Box<2>{box.lower - margin, box.upper + margin}.contains(middle);
  });
  return std::ranges::any_of(geom::straight_sides(shape.active), [&](const geom::StraightSide& side) {
    const auto d = static_cast<Eigen::Index>(side.axis);
    const double face = shape.line(side.axis, side.at);
    if (std::abs(a[d] - face) > near || std::abs(b[d] - face) > near) return false;
    const auto [low, high] = std::minmax(a[1 - d], b[1 - d]);
    const double shared =
        std::min(high, shape.line(1 - side.axis, side.to)) - std::max(low, shape.line(1 - side.axis, side.from));
    return shared > near || !inside;
  });
}
} // namespace

crack::CrackSet find_seams(const mesh::Mesh& mesh, std::span<const PatchShape> patches, double reach)
{
  const auto wanted = [&](const Vector<2>& a, const Vector<2>& b) {
    return std::any_of(patches.begin(), patches.end(), [&](const PatchShape& shape) {
      const Vector<2> margin = Vector<2>::Constant(reach * shape.lattice.dx);
      const bool near = std::ranges::any_of(shape.boxes, [&](const geom::Box<2>& box) {
        return geom::clip<2>(a, b, {box.lower - margin, box.upper + margin}).has_value();
      });
      return near && (reach > 0.0 || !on_border(shape, a, b));
    });
  };
  const std::vector<Side> all = boundary_sides(mesh, [](const Vector<2>&, const Vector<2>&) { return true; });
  std::vector<Side> sides;
  for (const Side& side : all)
    if (wanted(vector(side.a), vector(side.b))) sides.push_back(side);
  if (sides.empty()) return {};
  const Segments whole(all);
  std::set<std::pair<std::size_t, std::size_t>> chosen;
  for (const Side& side : sides) chosen.insert(std::minmax(whole.number(side.a), whole.number(side.b)));

  std::vector<crack::Polyline> lines;
  std::set<Point> inside, mouths; // ends in the material, and where a seam leaves it, perhaps to go on along a border
  for (auto [a, b] : chosen) {
    if (a == b) continue;
    const Vector<2> along = whole.direction(a, b);
    if (std::abs(along[0]) > 1e-6 ? along[0] < 0.0 : along[1] < 0.0) std::swap(a, b); // one side is left all along
    crack::Polyline line{whole.point(a), whole.point(b)};
    const auto before = whole.beyond(b, a);
    auto after = whole.beyond(a, b);
    if (after == before) after.reset(); // a hole of three sides
    const auto kept = [&](std::size_t from, std::optional<std::size_t> to) {
      return to && chosen.contains(std::minmax(from, *to));
    };
    if (kept(a, before)) line.insert(line.begin(), whole.point(*before));
    if (kept(b, after)) line.push_back(whole.point(*after));
    for (const auto& [end, next] : {std::pair(a, before), std::pair(b, after)})
      if (whole.tip(end) || !kept(end, next))
        (whole.tip(end) ? inside : mouths).insert({whole.point(end)[0], whole.point(end)[1]});
    if (kept(a, before)) inside.insert({line.front()[0], line.front()[1]});
    if (kept(b, after)) inside.insert({line.back()[0], line.back()[1]});
    lines.push_back(std::move(line));
  }
  const auto ends_there = [&](const Vector<2>& x) {
    return inside.contains({x[0], x[1]}) && !mouths.contains({x[0], x[1]});
  };
  return {std::move(lines), ends_there, kProlong * mesh.bounds().size().maxCoeff()};
}
} // namespace pdx::couple
