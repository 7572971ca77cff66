#include "parted_cell.hpp"

#include <algorithm>

namespace pdx::track {
namespace {
constexpr Index kPairReach = 2; // spacings per direction to the other particle of a pair
constexpr double kSlack = 1.0;  // spacings

/// Bodies that are more than crumbs; none if they are not two.
std::optional<std::pair<int, int>> two_bodies(const Bodies& bodies)
{
  std::vector<int> particles(static_cast<std::size_t>(bodies.count));
  for (const int body : bodies.body) ++particles[static_cast<std::size_t>(body)];
  std::vector<int> large;
  for (int b = 0; b < bodies.count; ++b)
    if (particles[static_cast<std::size_t>(b)] > kCrumbs) large.push_back(b);
  if (large.size() != 2) return std::nullopt;
  return std::pair(large[0], large[1]);
}

struct Midpoint {
  Vector<2> at;
  double weight;
};

/// Labels of the sites of a window.
class Labels {
public:
  explicit Labels(const Bodies& bodies) : lower_(bodies.sites[0]), upper_(bodies.sites[0])
  {
    for (const Site<2>& site : bodies.sites)
      for (std::size_t d = 0; d < 2; ++d) {
        lower_[d] = std::min(lower_[d], site[d]);
        upper_[d] = std::max(upper_[d], site[d]);
      }
    body_.assign(
        static_cast<std::size_t>(upper_[0] - lower_[0] + 1) * static_cast<std::size_t>(upper_[1] - lower_[1] + 1), -1);
    for (std::size_t k = 0; k < bodies.sites.size(); ++k) body_[number(bodies.sites[k])] = bodies.body[k];
  }
  int of(const Site<2>& site) const
  {
    for (std::size_t d = 0; d < 2; ++d)
      if (site[d] < lower_[d] || site[d] > upper_[d]) return -1;
    return body_[number(site)];
  }

private:
  std::size_t number(const Site<2>& site) const
  {
    return static_cast<std::size_t>(site[1] - lower_[1]) * static_cast<std::size_t>(upper_[0] - lower_[0] + 1) +
           static_cast<std::size_t>(site[0] - lower_[0]);
  }
  Site<2> lower_, upper_;
  std::vector<int> body_;
};

/// Half way from a site to the nearest particle of another body, to the middle of those that are equally near.
std::optional<Vector<2>> half_way(const Labels& labels, const Site<2>& site, int other)
{
  Index nearest = kPairReach * kPairReach + 2;
  Vector<2> sum = Vector<2>::Zero();
  int count = 0;
  for (Index j = -kPairReach; j <= kPairReach; ++j)
    for (Index i = -kPairReach; i <= kPairReach; ++i) {
      const Index square = i * i + j * j;
      if (square > nearest || labels.of({site[0] + i, site[1] + j}) != other) continue;
      if (square < nearest) {
        nearest = square;
        sum.setZero();
        count = 0;
      }
      sum += Vector<2>(i, j);
      ++count;
    }
  if (count == 0) return std::nullopt;
  return middle_of(site) + 0.5 / count * sum;
}

double outside(const CellBox& cell, const Vector<2>& x)
{
  return (cell.lower - x).cwiseMax(x - cell.upper).cwiseMax(0.0).norm();
}

Line fitted(const std::vector<Midpoint>& points, const Vector<2>& heading)
{
  double weight = 0.0;
  Vector<2> at = Vector<2>::Zero();
  for (const Midpoint& p : points) {
    weight += p.weight;
    at += p.weight * p.at;
  }
  at /= weight;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  for (const Midpoint& p : points) {
    const Vector<2> from = p.at - at;
    xx += p.weight * from[0] * from[0];
    xy += p.weight * from[0] * from[1];
    yy += p.weight * from[1] * from[1];
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
  Vector<2> along(std::cos(angle), std::sin(angle));
  if (along.dot(heading) < 0.0) along = -along;
  return {at, along};
}
} // namespace

std::optional<Parted> parted(const BondGraph& graph, const CellBox& cell, const Line& start, const Vector<2>& heading)
{
  const double horizon = graph.horizon() / graph.lattice().dx;
  const Vector<2> border = Vector<2>::Constant(horizon);
  Bodies bodies = bodies_in(graph, in_metres(graph.lattice(), CellBox{cell.lower - border, cell.upper + border}));
  const auto two = two_bodies(bodies);
  if (!two) return std::nullopt;
  const Labels labels(bodies);
  std::vector<Midpoint> points;
  double weight = 0.0;
  for (std::size_t k = 0; k < bodies.sites.size(); ++k) {
    if (bodies.body[k] != two->first && bodies.body[k] != two->second) continue;
    const int other = bodies.body[k] == two->first ? two->second : two->first;
    const auto at = half_way(labels, bodies.sites[k], other);
    if (!at) continue;
    const double ahead = fade(-start.along.dot(*at - start.at), -0.5, 0.5);
    points.push_back({*at, ahead * fade(outside(cell, *at), 0.0, horizon)});
    weight += points.back().weight;
  }
  if (weight < 1.0) return std::nullopt;
  return Parted{std::move(bodies), fitted(points, heading)};
}

bool parts_along(const BondGraph& graph, const Bodies& bodies, const CellBox& cell, const Line& line)
{
  Bodies inside;
  inside.count = bodies.count;
  for (std::size_t k = 0; k < bodies.sites.size(); ++k)
    if (cell.holds(middle_of(bodies.sites[k]))) {
      inside.sites.push_back(bodies.sites[k]);
      inside.body.push_back(bodies.body[k]);
    }
  const geom::Lattice<2>& lattice = graph.lattice();
  const auto offset = [&](const Vector<2>& x) { return line.offset(in_spacings(lattice, x)); };
  return are_sides(
      inside, graph, [&](const Vector<2>& x) { return offset(x) > 0.0 ? 1 : 0; },
      [&](const Vector<2>& x) { return lattice.dx * std::abs(offset(x)); }, kSlack * lattice.dx);
}
} // namespace pdx::track
