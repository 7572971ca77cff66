#include "laplacian.hpp"

#include "point_cloud.hpp"

#include <algorithm>

namespace pdx::track {
namespace {
constexpr double kNearRidge = 2.0;   // spacings beside a path, within which particles say where it goes on
constexpr double kLeast = 1e-6;      // of a weight
constexpr double kHalf = 0.5;        // of how low it was at most
constexpr std::size_t kPatience = 2; // spacings after which it does not get low again

double depth_at(const BondGraph& graph, const Site<2>& site)
{
  return graph.has(site) ? std::max(0.0, -laplacian_at(graph, site)) : 0.0;
}

/// Calls visit(site) for the sites around a point.
template <class Visit> void for_each_around(const Vector<2>& x, double reach, Visit&& visit)
{
  for (auto j = static_cast<Index>(std::floor(x[1] - reach)); j <= static_cast<Index>(std::floor(x[1] + reach)); ++j)
    for (auto i = static_cast<Index>(std::floor(x[0] - reach)); i <= static_cast<Index>(std::floor(x[0] + reach)); ++i)
      visit(Site<2>{i, j});
}

class Ridge {
public:
  Ridge(const BondGraph& graph, const Line& start)
      : graph_(graph), start_(start), horizon_(graph.horizon() / graph.lattice().dx), path_{start.at}
  {}

  Ahead find()
  {
    Vector<2> along = start_.along;
    depths_.push_back(depth(start_));
    double most = depths_[0];
    std::size_t last = 0; // where it is low enough
    while (most > kLeast && path_.size() - last <= kPatience + 1 && along.dot(start_.along) > 0.0) {
      step(along);
      most = std::max(most, depths_.back());
      if (depths_.back() >= kHalf * most) last = path_.size() - 1;
    }
    return until(last, kHalf * most);
  }

private:
  /// How low the Laplacian is where a line begins: of particles beside it, those up to a spacing before and behind.
  double depth(const Line& line) const
  {
    double sum = 0.0;
    for_each_around(line.at, kNearRidge + 1.5, [&](const Site<2>& site) {
      const Vector<2> x = middle_of(site);
      const double weight = fade(std::abs(line.along.dot(x - line.at)), 0.0, 1.0) *
                            fade(std::abs(line.offset(x)), kNearRidge, kNearRidge + 1.0);
      if (weight > 0.0) sum += weight * depth_at(graph_, site);
    });
    return sum;
  }

  /// Goes on by a spacing, towards the middle of what is low ahead.
  void step(Vector<2>& along)
  {
    const Line straight{path_.back(), along};
    Vector<2> sum = Vector<2>::Zero();
    double all = 0.0;
    for_each_around(straight.at + 0.5 * horizon_ * along, 0.5 * horizon_ + kNearRidge, [&](const Site<2>& site) {
      const Vector<2> x = middle_of(site);
      const double ahead = along.dot(x - straight.at), beside = std::abs(straight.offset(x));
      const double weight = fade(-ahead, 0.0, 0.5) * fade(ahead, 0.5 * horizon_, horizon_) *
                            fade(beside, kNearRidge, kNearRidge + 1.0) * depth_at(graph_, site);
      sum += weight * (x - straight.at);
      all += weight;
    });
    if (all > kLeast && sum.norm() > kLeast * all) along = (along + sum / all / horizon_).normalized();
    path_.push_back(path_.back() + along);
    depths_.push_back(depth({path_.back(), along}));
  }

  /// The path to where it is no lower than `least`, straight between two of its points.
  Ahead until(std::size_t last, double least) const
  {
    if (depths_[last] <= least) return {start_, {start_.at}, 0.0};
    if (last + 1 == path_.size()) return {{path_[last], (path_[last] - path_[last - 1])}, path_, 1.0};
    const double share = (depths_[last] - least) / (depths_[last] - depths_[last + 1]);
    const Vector<2> way = path_[last + 1] - path_[last];
    Ahead ahead{
        {path_[last] + share * way, way}, {path_.begin(), path_.begin() + static_cast<std::ptrdiff_t>(last) + 1}, 1.0};
    ahead.way.push_back(ahead.tip.at);
    return ahead;
  }

  const BondGraph& graph_;
  Line start_;
  double horizon_;              // in spacings
  std::vector<Vector<2>> path_; // a spacing between neighbours
  std::vector<double> depths_;  // at each of them
};
} // namespace

double damage_at(const BondGraph& graph, const Site<2>& site)
{
  double all = 0.0, gone = 0.0;
  const auto count = [&](const Site<2>& lower, std::size_t h) {
    if (!graph.begins(lower, h)) return;
    const double volume = graph.stencil().half[h].volume_share;
    all += volume;
    if (graph.gone(lower, h)) gone += volume;
  };
  for (std::size_t h = 0; h < graph.stencil().half.size(); ++h) {
    const Site<2>& step = graph.stencil().half[h].step;
    count(site, h);
    count({site[0] - step[0], site[1] - step[1]}, h);
  }
  return all > 0.0 ? gone / all : 0.0;
}

double laplacian_at(const BondGraph& graph, const Site<2>& site)
{
  const double here = damage_at(graph, site);
  double sum = 0.0;
  for (const Site<2>& step : {Site<2>{1, 0}, Site<2>{-1, 0}, Site<2>{0, 1}, Site<2>{0, -1}}) {
    const Site<2> other{site[0] + step[0], site[1] + step[1]};
    if (graph.has(other)) sum += damage_at(graph, other) - here;
  }
  return sum;
}

std::optional<Line> ridge_in(const BondGraph& graph, std::span<const Site<2>> sites,
                             const std::function<double(const Vector<2>&)>& weight, const Vector<2>& heading)
{
  PointCloud cloud;
  for (const Site<2>& site : sites)
    if (const double w = weight(middle_of(site)); w > 0.0) cloud.add(middle_of(site), w * depth_at(graph, site));
  if (cloud.weight < kLeast) return std::nullopt;
  return cloud.line(heading);
}

Ahead ridge_ahead(const BondGraph& graph, const Line& start) { return Ridge(graph, start).find(); }
} // namespace pdx::track
