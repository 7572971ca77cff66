#include "pdx/adapt/crack_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::adapt {
namespace {
constexpr double kStraight = 1e-9; // sine of a bend that is rounding

bool goes_straight_on(const Vector<2>& before, const Vector<2>& at, const Vector<2>& next)
{
  const Vector<2> way = (at - before).normalized(), on = (next - at).normalized();
  return way.dot(on) > 0.0 && std::abs(way.x() * on.y() - way.y() * on.x()) < kStraight;
}

double distance_to_piece(const Vector<2>& a, const Vector<2>& b, const Vector<2>& x)
{
  const Vector<2> along = b - a;
  const double t = std::clamp((x - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (x - a - t * along).norm();
}
} // namespace

crack::Polyline gone_on(crack::Polyline crack, bool last, std::span<const Vector<2>> ahead)
{
  if (!last) std::ranges::reverse(crack);
  const std::size_t known = crack.size();
  for (const Vector<2>& next : ahead) {
    if (next == crack.back()) continue;
    const std::size_t count = crack.size();
    if (count > known && goes_straight_on(crack[count - 2], crack[count - 1], next))
      crack.back() = next;
    else
      crack.push_back(next);
  }
  if (!last) std::ranges::reverse(crack);
  return crack;
}

double distance(std::span<const crack::Polyline> chains, const Vector<2>& x)
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const crack::Polyline& chain : chains)
    for (std::size_t k = 0; k + 1 < chain.size(); ++k)
      nearest = std::min(nearest, distance_to_piece(chain[k], chain[k + 1], x));
  return nearest;
}

double distance(const geom::Box<2>& box, const Vector<2>& x)
{
  return (x - x.cwiseMax(box.lower).cwiseMin(box.upper)).norm();
}
} // namespace pdx::adapt
