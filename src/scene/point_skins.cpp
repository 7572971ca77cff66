#include "point_skins.hpp"

#include "pdx/geom/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::scene {
namespace point_skins {
constexpr double kOnBorder = 1e-6; // of a spacing: a site as near to the border has no direction from there
constexpr double kFarthest = 1.5;  // of a spacing: what would move farther stays on its site

template <int Dim> Vector<Dim> keep_near(const Vector<Dim>& site, const Vector<Dim>& moved, double spacing)
{
  return (moved - site).norm() <= kFarthest * spacing ? moved : site;
}

/// Of a round body, whose sites mirror about its centre.
template <int Dim, int Round>
Vector<Dim> within_ball(const options::PointShape::Ball& ball, double spacing, const Vector<Dim>& site)
{
  Vector<Dim> moved = site;
  const Vector<Round> from = (site.template head<Round>() - ball.centre.template head<Round>()).eval();
  const double radius = ball.radius - 0.5 * spacing;
  if (radius > 0.0 && from.norm() > 0.0)
    moved.template head<Round>() = ball.centre.template head<Round>() + from * (radius / from.norm());
  return keep_near<Dim>(site, moved, spacing);
}

/// An edge as seen from a place in the shape.
struct Seen {
  Vector<2> normal;                                          ///< from its nearest point to the place, of length 1
  double distance = std::numeric_limits<double>::infinity(); ///< [m]
};

/// What a border of edges encloses.
class Enclosure {
public:
  Enclosure(std::vector<std::array<Vector<2>, 2>> border, double spacing, std::function<bool(const Vector<2>&)> inside)
      : border_(std::move(border)), spacing_(spacing), inside_(std::move(inside))
  {}

  /// Half a spacing from the nearest edge, and from the next if that is nearer then: a corner.
  Vector<2> skin(const Vector<2>& site) const
  {
    const double deep = 0.5 * spacing_;
    const Seen first = nearest(site, nullptr);
    if (!(first.distance < 2.0 * spacing_)) return site;
    const Vector<2> moved = site + (deep - first.distance) * first.normal;
    const Seen second = nearest(site, &first.normal), next = nearest(moved, &first.normal);
    const bool on_bisector = std::abs(second.distance - first.distance) < kOnBorder * spacing_;
    if (!(next.distance < deep * (1.0 - kOnBorder)) && !on_bisector) return moved;
    return corner(site, first, second, moved);
  }

private:
  Seen see(const std::array<Vector<2>, 2>& edge, const Vector<2>& x) const
  {
    const auto [a, b] = geom::nearest_on_segment<2>(edge[0], edge[1], x);
    const Vector<2> from = x - a * edge[0] - b * edge[1];
    const double distance = from.norm();
    if (distance > kOnBorder * spacing_) return {from / distance, distance};
    const Vector<2> along = (edge[1] - edge[0]).normalized(), side(-along[1], along[0]);
    const double step = kSide * spacing_;
    return {inside_(x + step * side) || !inside_(x - step * side) ? side : Vector<2>(-side), 0.0};
  }

  /// @param but for edges with that normal
  Seen nearest(const Vector<2>& x, const Vector<2>* but) const
  {
    Seen best;
    for (const auto& edge : border_) {
      if (edge[0] == edge[1]) continue;
      const Seen seen = see(edge, x);
      if (seen.distance < best.distance && !(but && seen.normal.dot(*but) > kAlike)) best = seen;
    }
    return best;
  }

  /// Half a spacing from two edges.
  Vector<2> corner(const Vector<2>& site, const Seen& a, const Seen& b, const Vector<2>& otherwise) const
  {
    const double deep = 0.5 * spacing_, cosine = a.normal.dot(b.normal), sine2 = 1.0 - cosine * cosine;
    if (!(sine2 > kFlat) || !std::isfinite(b.distance)) return otherwise;
    const double by_a = deep - a.distance, by_b = deep - b.distance;
    return site + ((by_a - cosine * by_b) * a.normal + (by_b - cosine * by_a) * b.normal) / sine2;
  }

  static constexpr double kSide = 1e-3;      // of a spacing: a step to one side of the border
  static constexpr double kAlike = 1 - 1e-9; // of a cosine: edges in one line are one
  static constexpr double kFlat = 1e-3;      // of a squared sine: such edges do not meet in a corner
  std::vector<std::array<Vector<2>, 2>> border_;
  double spacing_;
  std::function<bool(const Vector<2>&)> inside_;
};
} // namespace point_skins

template <int Dim>
std::function<Vector<Dim>(const Vector<Dim>& site, unsigned uncovered)>
skin_of(const options::PointShape& shape, double spacing, std::function<bool(const Vector<2>&)> inside)
{
  constexpr unsigned kInPlane = 0b11; // directions
  if constexpr (Dim == 3)
    if (shape.sphere)
      return [ball = *shape.sphere, spacing](const Vector<3>& site, unsigned) {
        return point_skins::within_ball<3, 3>(ball, spacing, site);
      };
  if (shape.disc)
    return [ball = *shape.disc, spacing](const Vector<Dim>& site, unsigned uncovered) {
      return uncovered & kInPlane ? point_skins::within_ball<Dim, 2>(ball, spacing, site) : site;
    };
  if (shape.border.empty()) return {};
  return [enclosure = point_skins::Enclosure(shape.border, spacing, std::move(inside)),
          spacing](const Vector<Dim>& site, unsigned uncovered) {
    if (!(uncovered & kInPlane)) return site;
    Vector<Dim> moved = site;
    moved.template head<2>() = enclosure.skin(site.template head<2>());
    return point_skins::keep_near<Dim>(site, moved, spacing);
  };
}

template std::function<Vector<2>(const Vector<2>&, unsigned)> skin_of<2>(const options::PointShape&, double,
                                                                         std::function<bool(const Vector<2>&)>);
template std::function<Vector<3>(const Vector<3>&, unsigned)> skin_of<3>(const options::PointShape&, double,
                                                                         std::function<bool(const Vector<2>&)>);
} // namespace pdx::scene
