#include "pdx/crack/crack_set.hpp"

#include "parting.hpp"
#include "pdx/base/error.hpp"
#include "pdx/geom/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::crack {
namespace {
constexpr double kSurface = 1e-9; // of the body's size: an end this near to its surface is on it
constexpr double kProlong = 1e-3; // of the body's size
/// Of the prolongation: lattices like to have bonds through the tip itself, which rounding must not cut.
constexpr double kTipShare = 1e-9;
/// Of a tip's reach: a bond that passes the tip within its reach crosses the crack no further behind it, unless it runs
/// almost along the crack.
constexpr double kBehindTip = 100.0;
/// Of the prolongation: an end this near to another crack is on it.
constexpr double kJunctionShare = 1e-6;
constexpr double kShiftShare = 1e-10; // of the prolongation: above rounding, below kTipShare
constexpr double kSharpest = 1e-6;    // 1 + cosine of the turn: below, corners are cut short

/// Distance of x from the segment between a and b, the same for (b, a).
double distance(const Vector<2>& x, Vector<2> a, Vector<2> b)
{
  if (std::pair(b[0], b[1]) < std::pair(a[0], a[1])) std::swap(a, b);
  const Vector<2> along = b - a;
  const double t = std::clamp((x - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (x - a - t * along).norm();
}

/// The first crack other than the one of this number that x lies on, to `reach` [m]; -1: none.
int other_at(const std::vector<Polyline>& cracks, std::size_t number, const Vector<2>& x, double reach)
{
  for (std::size_t k = 0; k < cracks.size(); ++k)
    for (std::size_t j = 0; k != number && j + 1 < cracks[k].size(); ++j)
      if (distance(x, cracks[k][j], cracks[k][j + 1]) < reach) return static_cast<int>(k);
  return -1;
}

/// Do two pieces share more than a point, to `reach` [m]?
bool run_along(const std::array<Vector<2>, 2>& p, const std::array<Vector<2>, 2>& q, double reach)
{
  Polyline shared; // ends of either on the other
  for (std::size_t k = 0; k < 2; ++k) {
    if (distance(p[k], q[0], q[1]) < reach) shared.push_back(p[k]);
    if (distance(q[k], p[0], p[1]) < reach) shared.push_back(q[k]);
  }
  return std::any_of(shared.begin(), shared.end(),
                     [&](const Vector<2>& x) { return (x - shared.front()).norm() > 2.0 * reach; });
}

void refuse_doubles(const std::vector<Polyline>& cracks, double reach)
{
  for (std::size_t a = 0; a < cracks.size(); ++a)
    for (std::size_t b = a + 1; b < cracks.size(); ++b)
      for (std::size_t i = 0; i + 1 < cracks[a].size(); ++i)
        for (std::size_t j = 0; j + 1 < cracks[b].size(); ++j)
          if (run_along({cracks[a][i], cracks[a][i + 1]}, {cracks[b][j], cracks[b][j + 1]}, reach))
            throw UserError(
                fmt::format("cracks {} and {} run along each other: give each piece of the line once", a + 1, b + 1));
}

Vector<2> direction(const Vector<2>& from, const Vector<2>& to) { return (to - from).normalized(); }
double cross(const Vector<2>& a, const Vector<2>& b) { return a.x() * b.y() - a.y() * b.x(); }

void check(const Polyline& points, std::size_t number)
{
  const auto refuse = [number](const std::string& what) {
    throw UserError(fmt::format("crack {}: {}", number + 1, what));
  };
  const auto text = [](const Vector<2>& x) { return fmt::format("({:.10g}, {:.10g})", x.x(), x.y()); };
  if (points.size() < 2) refuse(fmt::format("{} point(s) given; a crack needs two or more", points.size()));
  for (const Vector<2>& x : points)
    if (!x.allFinite()) refuse("a coordinate is not a finite number");
  for (std::size_t k = 0; k + 1 < points.size(); ++k)
    if (points[k] == points[k + 1]) refuse(fmt::format("the point {} is there twice; give it once", text(points[k])));
  for (std::size_t k = 1; k + 1 < points.size(); ++k)
    if (geom::orientation(points[k - 1], points[k], points[k + 1]) == 0 &&
        (points[k] - points[k - 1]).dot(points[k + 1] - points[k]) < 0.0)
      refuse(fmt::format("it turns back on itself at {}", text(points[k])));
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    for (std::size_t j = i + 2; j + 1 < points.size(); ++j)
      if (meet(points[i], points[i + 1], points[j], points[j + 1]))
        refuse(fmt::format("the piece from {} and the piece from {} meet; give branches as cracks of their own",
                           text(points[i]), text(points[j])));
}

/// The chain moved to its right by `shift` [m].
Polyline shifted(const Polyline& points, double shift)
{
  const auto right_of = [&points](std::size_t k) {
    const Vector<2> along = direction(points[k], points[k + 1]);
    return Vector<2>(along.y(), -along.x());
  };
  Polyline moved = points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vector<2> before = right_of(k == 0 ? 0 : k - 1), after = right_of(std::min(k, points.size() - 2));
    moved[k] += shift / std::max(1.0 + before.dot(after), kSharpest) * (before + after);
  }
  return moved;
}

geom::Box<2> bounds_of(const Polyline& points)
{
  geom::Box<2> box{points[0], points[0]};
  for (const Vector<2>& x : points) {
    box.lower = box.lower.cwiseMin(x);
    box.upper = box.upper.cwiseMax(x);
  }
  return box;
}
} // namespace

/// The point of a crack nearest to some x.
struct CrackSet::Foot {
  std::size_t segment = 0; ///< from point `segment` to the next
  double t = 0.0;          ///< place on it, 0 to 1              [-]
  double squared = 0.0;    ///< square of its distance from x    [m^2]
};

CrackSet::CrackSet(std::vector<Polyline> cracks, const geom::Box<2>& body)
{
  const double size = body.size().maxCoeff(), prolong = kProlong * size;
  for (std::size_t k = 0; k < cracks.size(); ++k) check(cracks[k], k);
  refuse_doubles(cracks, kJunctionShare * prolong);
  for (std::size_t k = 0; k < cracks.size(); ++k)
    add(
        cracks[k], [&](const Vector<2>& x) { return body.contains(x, -kSurface * size); }, prolong,
        [&](const Vector<2>& end) { return other_at(cracks, k, end, kJunctionShare * prolong); });
}

CrackSet::CrackSet(std::vector<Polyline> cracks, const Inside& inside, double prolong)
{
  for (std::size_t k = 0; k < cracks.size(); ++k) check(cracks[k], k);
  for (const Polyline& points : cracks) add(points, inside, prolong, [](const Vector<2>&) { return -1; });
}

void CrackSet::add(const Polyline& points, const Inside& inside, double prolong, const Joins& joins)
{
  Crack crack{points, points, {}, {}, {}, {}, kTipShare * prolong};
  const std::size_t end = points.size() - 1;
  for (const bool last : {false, true}) {
    const Vector<2>& at = last ? points[end] : points[0];
    const Vector<2> out = last ? direction(points[end - 1], at) : direction(points[1], at);
    if (const int other = joins(at); other >= 0) {
      junctions_.push_back({size(), other, at});
      // Not a point more: a piece as short would point where rounding says.
      (last ? crack.seen.back() : crack.seen.front()) = at + 2.0 * kJunctionShare * prolong * out;
      continue;
    }
    if (inside(at)) {
      tips_.push_back({size(), last, at, out});
      crack.tips.push_back(at);
      continue;
    }
    const Vector<2> further = at + prolong * out;
    if (!inside(further)) crack.seen.insert(last ? crack.seen.end() : crack.seen.begin(), further);
  }
  crack.parting = shifted(crack.seen, kShiftShare * prolong);
  crack.bounds = bounds_of(crack.parting);
  crack.withdrawn = crack.seen;
  for (const Vector<2>& tip : crack.tips) {
    const bool last = tip == points[end];
    const Vector<2> back = (last ? points[end - 1] : points[1]) - tip;
    const double share = std::min(0.5, kBehindTip * crack.tip_reach / back.norm());
    (last ? crack.withdrawn.back() : crack.withdrawn.front()) = tip + share * back;
  }
  crack.withdrawn = shifted(crack.withdrawn, kShiftShare * prolong);
  cracks_.push_back(std::move(crack));
}

double CrackSet::length(int crack) const
{
  double sum = 0.0;
  const Polyline& p = points(crack);
  for (std::size_t k = 0; k + 1 < p.size(); ++k) sum += (p[k + 1] - p[k]).norm();
  return sum;
}

CrackSet::Foot CrackSet::foot(const Polyline& p, const Vector<2>& x)
{
  Foot best;
  for (std::size_t k = 0; k + 1 < p.size(); ++k) {
    const Vector<2> along = p[k + 1] - p[k];
    const double t = std::clamp((x - p[k]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double squared = (x - p[k] - t * along).squaredNorm();
    if (k == 0 || squared < best.squared) best = {k, t, squared};
  }
  return best;
}

int CrackSet::side(int crack, const Vector<2>& x) const
{
  const Polyline& p = cracks_[static_cast<std::size_t>(crack)].parting;
  const Foot f = foot(p, x);
  const std::size_t corner = f.segment + (f.t >= 1.0 ? 1 : 0);
  if ((f.t <= 0.0 || f.t >= 1.0) && corner > 0 && corner + 1 < p.size())
    return left_at(p[corner - 1], p[corner], p[corner + 1], x) ? 1 : -1;
  return geom::orientation(p[f.segment], p[f.segment + 1], x) >= 0 ? 1 : -1;
}

double CrackSet::signed_distance(int crack, const Vector<2>& x) const
{
  const Polyline& p = cracks_[static_cast<std::size_t>(crack)].seen;
  const Foot f = foot(p, x);
  const std::size_t corner = f.segment + (f.t >= 1.0 ? 1 : 0);
  const bool at_corner = (f.t <= 0.0 || f.t >= 1.0) && corner > 0 && corner + 1 < p.size();
  const Vector<2>&from = p[f.segment], &to = p[f.segment + 1];
  const double distance = at_corner ? std::sqrt(f.squared) : std::abs(cross(direction(from, to), x - from));
  return side(crack, x) * distance;
}

double CrackSet::beyond(int crack, const Vector<2>& x) const
{
  const Polyline& p = cracks_[static_cast<std::size_t>(crack)].seen;
  const Foot f = foot(p, x);
  if (f.t <= 0.0 && f.segment == 0) return direction(p[1], p[0]).dot(x - p[0]);
  if (f.t >= 1.0 && f.segment + 2 == p.size()) return direction(p[f.segment], p.back()).dot(x - p.back());
  return 0.0;
}

bool CrackSet::cuts(int crack, const Vector<2>& a, const Vector<2>& b) const
{
  const Crack& c = cracks_[static_cast<std::size_t>(crack)];
  if ((a.cwiseMin(b).array() > c.bounds.upper.array()).any() || (a.cwiseMax(b).array() < c.bounds.lower.array()).any())
    return false;
  if (!parts(c.parting, a, b)) return false;
  const bool meets_tip = std::any_of(c.tips.begin(), c.tips.end(),
                                     [&](const Vector<2>& tip) { return distance(tip, a, b) < c.tip_reach; });
  return !meets_tip || parts(c.withdrawn, a, b);
}

bool CrackSet::cuts(const Vector<2>& a, const Vector<2>& b) const
{
  for (int crack = 0; crack < size(); ++crack)
    if (cuts(crack, a, b)) return true;
  return false;
}

bool CrackSet::near(const Vector<2>& x, double reach) const
{
  return std::any_of(cracks_.begin(), cracks_.end(),
                     [&](const Crack& crack) { return crack.bounds.contains(x, 1.000001 * reach); });
}
} // namespace pdx::crack
