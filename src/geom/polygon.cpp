#include "pdx/geom/polygon.hpp"

#include "pdx/base/error.hpp"

namespace pdx::geom {
namespace {
double triangle_area(const Vector<2>& a, const Vector<2>& b, const Vector<2>& c)
{
  const Vector<2> ab = b - a, ac = c - a;
  return 0.5 * (ab.x() * ac.y() - ab.y() * ac.x());
}

/// Two orbits of three points: barycentric coordinate of the two equal ones, share of the area per point.
struct Orbit {
  double equal, weight;
};
constexpr std::array kDegree4{Orbit{0.44594849091596488632, 0.22338158967801146570},
                              Orbit{0.09157621350977074346, 0.10995174365532186764}};

void append_triangle(const std::array<Vector<2>, 3>& corner, double area, std::vector<WeightedPoint>& points)
{
  const Vector<2> sum = corner[0] + corner[1] + corner[2];
  for (const Orbit& orbit : kDegree4)
    for (const Vector<2>& odd : corner)
      points.push_back({orbit.equal * sum + (1.0 - 3.0 * orbit.equal) * odd, orbit.weight * area});
}
} // namespace

double area(std::span<const Vector<2>> corners)
{
  double sum = 0.0;
  for (std::size_t i = 2; i < corners.size(); ++i) sum += triangle_area(corners[0], corners[i - 1], corners[i]);
  return sum;
}

Split split(std::span<const Vector<2>> corners, std::span<const double> distance)
{
  PDX_ASSERT(corners.size() == distance.size());
  Split parts;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t next = (i + 1) % corners.size();
    const double here = distance[i], there = distance[next];
    if (here <= 0.0) parts.minus.push_back(corners[i]);
    if (here >= 0.0) parts.plus.push_back(corners[i]);
    if ((here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0)) {
      const Vector<2> crossing = corners[i] + here / (here - there) * (corners[next] - corners[i]);
      parts.minus.push_back(crossing);
      parts.plus.push_back(crossing);
    }
  }
  for (Polygon* part : {&parts.minus, &parts.plus})
    if (part->size() < 3 || area(*part) <= 0.0) part->clear();
  return parts;
}

std::vector<WeightedPoint> quadrature(std::span<const Vector<2>> corners)
{
  std::vector<WeightedPoint> points;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const double part = triangle_area(corners[0], corners[i - 1], corners[i]);
    if (part > 0.0) append_triangle({corners[0], corners[i - 1], corners[i]}, part, points);
  }
  return points;
}
} // namespace pdx::geom
