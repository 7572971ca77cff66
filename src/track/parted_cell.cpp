#include "parted_cell.hpp"

#include "laplacian.hpp"
#include "point_cloud.hpp"
#include "soft_line.hpp"

#include <algorithm>

namespace pdx::track {
namespace {
constexpr Index kPairReach = 2; // spacings per direction to the other particle of a pair
constexpr double kSlack = 1.0;  // spacings
constexpr double kBeside = 3.0; // spacings to a line, within which particles decide where it is
constexpr double kFade = 1.5;   // horizons outside a cell, to where particles would decide on its line
constexpr double kFewest = 1.0; // midpoints that make a line
constexpr double kTurn = 0.2;   // cosine of the largest turn from cell to cell

struct Two {
  int first, second;
  bool has(int body) const { return body == first || body == second; }
  int other(int body) const { return body == first ? second : first; }
};

/// Bodies that are more than crumbs; none if they are not two.
std::optional<Two> two_bodies(const Bodies& bodies)
{
  std::vector<int> particles(static_cast<std::size_t>(bodies.count));
  for (const int body : bodies.body) ++particles[static_cast<std::size_t>(body)];
  std::vector<int> large;
  for (int b = 0; b < bodies.count; ++b)
    if (particles[static_cast<std::size_t>(b)] > kCrumbs) large.push_back(b);
  if (large.size() != 2) return std::nullopt;
  return Two{large[0], large[1]};
}

/// The particles of a cell and a horizon around it.
class Window {
public:
  Window(const BondGraph& graph, const CellBox& cell, const Line& start)
      : cell_(cell), start_(start), horizon_(graph.horizon() / graph.lattice().dx)
  {
    const Vector<2> border = Vector<2>::Constant(horizon_);
    const CellBox box{cell.lower - border, cell.upper + border};
    bodies = bodies_in(graph, in_metres(graph.lattice(), box));
    for (std::size_t d = 0; d < 2; ++d) {
      lower_[d] = static_cast<Index>(std::floor(box.lower[static_cast<int>(d)]));
      count_[d] = static_cast<Index>(std::ceil(box.upper[static_cast<int>(d)])) - lower_[d];
    }
    body_.assign(static_cast<std::size_t>(count_[0]) * static_cast<std::size_t>(count_[1]), -1);
    for (std::size_t k = 0; k < bodies.sites.size(); ++k) body_[number(bodies.sites[k])] = bodies.body[k];
  }

  /// Midpoints of nearest pairs.
  PointCloud midpoints(const Two& two) const
  {
    PointCloud cloud;
    for (std::size_t k = 0; k < bodies.sites.size(); ++k)
      if (two.has(bodies.body[k]))
        if (const auto x = half_way(bodies.sites[k], two.other(bodies.body[k]))) cloud.add(*x, weight(*x));
    return cloud;
  }

  /// Particles beside a line, the body with more of them on its left as those that should be there.
  std::vector<Labelled> labelled(const Two& two, const Line& line) const
  {
    std::vector<Labelled> all;
    double agree = 0.0;
    for (std::size_t k = 0; k < bodies.sites.size(); ++k) {
      if (!two.has(bodies.body[k])) continue;
      const Vector<2> x = middle_of(bodies.sites[k]);
      const double offset = line.offset(x), beside = fade(std::abs(offset), kBeside, kBeside + 1.0);
      all.push_back({x, bodies.body[k] == two.first ? 1.0 : -1.0, weight(x) * beside});
      agree += all.back().weight * all.back().side * offset;
    }
    if (agree < 0.0)
      for (Labelled& particle : all) particle.side = -particle.side;
    return all;
  }

  /// Lies what is behind the start on the same sides of the line, to one spacing? From then on it counts too.
  bool come_straight(const Two& two, const Line& line)
  {
    behind_ = true;
    for (const Labelled& particle : labelled(two, line)) {
      const double margin = particle.side * line.offset(particle.at);
      behind_ = behind_ && (particle.weight == 0.0 || margin > -kSlack);
    }
    return behind_;
  }

  /// Full in the cell, fading outside; none behind the start, unless the crack came straight from there.
  double weight(const Vector<2>& x) const
  {
    const double outside = (cell_.lower - x).cwiseMax(x - cell_.upper).cwiseMax(0.0).norm();
    const double behind = -start_.along.dot(x - start_.at);
    return (behind_ ? 1.0 : fade(behind, -0.5, 0.5)) * fade(outside, 0.0, kFade * horizon_);
  }

  Bodies bodies;

private:
  std::size_t number(const Site<2>& site) const
  {
    return static_cast<std::size_t>(site[1] - lower_[1]) * static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(site[0] - lower_[0]);
  }
  int body(const Site<2>& site) const
  {
    for (std::size_t d = 0; d < 2; ++d)
      if (site[d] < lower_[d] || site[d] >= lower_[d] + count_[d]) return -1;
    return body_[number(site)];
  }

  /// Half way from a site to the nearest particle of another body, to the middle of those that are equally near.
  std::optional<Vector<2>> half_way(const Site<2>& site, int other) const
  {
    Index nearest = kPairReach * kPairReach;
    Vector<2> sum = Vector<2>::Zero();
    int count = 0;
    for (Index j = -kPairReach; j <= kPairReach; ++j)
      for (Index i = -kPairReach; i <= kPairReach; ++i) {
        const Index square = i * i + j * j;
        if (square > nearest || body({site[0] + i, site[1] + j}) != other) continue;
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

  CellBox cell_;
  Line start_;
  double horizon_; // in spacings
  bool behind_ = false;
  Site<2> lower_{}, count_{};
  std::vector<int> body_; // of the sites of the window
};
} // namespace

std::optional<Parted> parted(const BondGraph& graph, const CellBox& cell, const Line& start, const Vector<2>& heading,
                             Tracker tracker)
{
  Window window(graph, cell, start);
  const auto two = two_bodies(window.bodies);
  if (!two) return std::nullopt;
  if (tracker == Tracker::laplacian) {
    const auto ridge = ridge_in(
        graph, window.bodies.sites, [&](const Vector<2>& x) { return window.weight(x); }, heading);
    if (!ridge || ridge->along.dot(heading) < kTurn) return std::nullopt;
    return Parted{std::move(window.bodies), *ridge};
  }
  const PointCloud cloud = window.midpoints(*two);
  if (cloud.weight < kFewest) return std::nullopt;
  Line line = cloud.line(heading);
  if (line.along.dot(heading) < kTurn) return std::nullopt;
  line = soft_line(window.labelled(*two, line), line, {});
  if (window.come_straight(*two, line)) line = soft_line(window.labelled(*two, line), line, {});
  return Parted{std::move(window.bodies), line};
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
