#include "crack_ahead.hpp"

#include <algorithm>

namespace pdx::track {
namespace {
constexpr int kShort = 2;           // square of the length of bonds that show where damage is, in spacings
constexpr double kSteadiness = 2.0; // bonds that are as much as straight on
constexpr double kOnPath = 1e-6;    // spacings: a particle nearer to the path is on either side
constexpr double kSample = 0.125;   // spacings between places where the share is looked at

/// A bond that crosses the path.
struct Crosser {
  double place;  // along the path, in spacings from its start
  double weight; // kappa; half of it if an end is on the path
  bool gone;
};

/// Calls visit(site) for the lattice sites within `reach` spacings of a box around two points.
template <class Visit> void for_each_site(const Vector<2>& a, const Vector<2>& b, double reach, Visit&& visit)
{
  const Vector<2> lower = a.cwiseMin(b).array() - reach, upper = a.cwiseMax(b).array() + reach;
  for (auto j = static_cast<Index>(std::floor(lower[1])); j <= static_cast<Index>(std::floor(upper[1])); ++j)
    for (auto i = static_cast<Index>(std::floor(lower[0])); i <= static_cast<Index>(std::floor(upper[0])); ++i)
      visit(Site<2>{i, j});
}

class Ahead {
public:
  Ahead(const BondGraph& graph, const Line& start)
      : graph_(graph), start_(start), horizon_(graph.horizon() / graph.lattice().dx), path_{start.at}
  {
    cross(start.at - start.along, start.at, -1.0);
  }

  Line tip()
  {
    const auto patience = static_cast<int>(std::ceil(horizon_)) + 1; // steps without damage after which there is none
    Vector<2> along = start_.along;
    for (int quiet = 0; quiet < patience && along.dot(start_.along) > 0.0;) quiet = step(along) ? 0 : quiet + 1;
    const auto ahead = [](const Crosser& bond) { return bond.gone && bond.place > kOnPath; };
    if (std::ranges::none_of(crossers_, ahead)) return start_;
    const double place = last_half();
    const Vector<2> at = point(place);
    return {at, (at - point(place - horizon_)).normalized()};
  }

private:
  /// Goes on by one spacing. Is at least half of what crosses it broken?
  bool step(Vector<2>& along)
  {
    const Vector<2> from = path_.back();
    const auto [offset, slope] = bend({from, along});
    const Vector<2> side = left_of(along);
    const Vector<2> to = from + (along + (offset + slope) * side).normalized();
    along = (along + slope * side).normalized();
    path_.push_back(to);
    return cross(from, to, static_cast<double>(path_.size()) - 2.0);
  }

  /// Offset and slope of the middles of broken short bonds against going straight on, as far as there are any.
  std::pair<double, double> bend(const Line& straight) const
  {
    Eigen::Matrix2d normal = kSteadiness * Eigen::Matrix2d::Identity();
    normal(1, 1) *= horizon_ * horizon_;
    Vector<2> right = Vector<2>::Zero();
    for_each_site(straight.at, straight.at + horizon_ * straight.along, 2.0, [&](const Site<2>& site) {
      for (std::size_t h = 0; h < graph_.stencil().half.size(); ++h) {
        const Site<2>& arm = graph_.stencil().half[h].step;
        if (arm[0] * arm[0] + arm[1] * arm[1] > kShort || !graph_.gone(site, h)) continue;
        const Vector<2> at = middle_of(site) + 0.5 * Vector<2>(arm[0], arm[1]);
        const double place = straight.along.dot(at - straight.at), offset = straight.offset(at);
        const double weight =
            fade(-place, 0.0, 1.0) * fade(place, 0.5 * horizon_, horizon_) * fade(std::abs(offset), 1.0, 2.0);
        const Vector<2> row(1.0, place);
        normal += weight * row * row.transpose();
        right += weight * offset * row;
      }
    });
    const double det = normal(0, 0) * normal(1, 1) - normal(0, 1) * normal(1, 0);
    return {(normal(1, 1) * right[0] - normal(0, 1) * right[1]) / det,
            (normal(0, 0) * right[1] - normal(1, 0) * right[0]) / det};
  }

  /// Notes the bonds that cross a piece of the path. Is at least half of their weight gone?
  bool cross(const Vector<2>& a, const Vector<2>& b, double place)
  {
    const Line line{a, (b - a).normalized()};
    double all = 0.0, gone = 0.0;
    for_each_site(a, b, graph_.stencil().reach, [&](const Site<2>& site) {
      const double offset = line.offset(middle_of(site));
      for (std::size_t h = 0; h < graph_.stencil().half.size(); ++h) {
        const Site<2> end = graph_.end_of(site, h);
        const double beyond = line.offset(middle_of(end));
        const int sides = side(offset) * side(beyond), ties = !side(offset) + !side(beyond);
        if (sides > 0 || ties == 2) continue;
        const double share = ties == 1 ? (side(offset) == 0 ? 0.0 : 1.0) : offset / (offset - beyond);
        const double at = line.along.dot(middle_of(site) + share * (middle_of(end) - middle_of(site)) - a);
        if (at < 0.0 || at >= 1.0 || !graph_.begins(site, h)) continue;
        const double weight = graph_.stencil().half[h].kappa * (ties ? 0.5 : 1.0);
        crossers_.push_back({place + at, weight, graph_.gone(site, h)});
        all += weight;
        if (crossers_.back().gone) gone += weight;
      }
    });
    return all > 0.0 && gone >= 0.5 * all;
  }
  static int side(double offset) { return offset > kOnPath ? 1 : offset < -kOnPath ? -1 : 0; }

  /// Last place where half the weight is broken, 0 if there is none.
  double last_half() const
  {
    const auto count = static_cast<std::size_t>(static_cast<double>(path_.size() - 1) / kSample) + 1;
    std::vector<double> all(count + 1), gone(count + 1);
    for (const Crosser& bond : crossers_)
      for (auto k = static_cast<std::size_t>(std::max(bond.place - 1.0, 0.0) / kSample);
           k < count && kSample * static_cast<double>(k) < bond.place + 1.0; ++k) {
        const double near = fade(std::abs(bond.place - kSample * static_cast<double>(k)), 0.0, 1.0);
        all[k] += near * bond.weight;
        if (bond.gone) gone[k] += near * bond.weight;
      }
    const auto excess = [&](std::size_t k) { return all[k] > 0.0 ? gone[k] / all[k] - 0.5 : -0.5; };
    for (std::size_t k = count; k-- > 0;)
      if (excess(k) >= 0.0)
        return kSample * (static_cast<double>(k) + (k + 1 < count ? excess(k) / (excess(k) - excess(k + 1)) : 0.0));
    return 0.0;
  }

  /// Of the path; before its start, straight back.
  Vector<2> point(double place) const
  {
    if (place <= 0.0) return start_.at + place * start_.along;
    const std::size_t k = std::min(static_cast<std::size_t>(place), path_.size() - 2);
    return path_[k] + (place - static_cast<double>(k)) * (path_[k + 1] - path_[k]);
  }

  const BondGraph& graph_;
  Line start_;
  double horizon_;              // in spacings
  std::vector<Vector<2>> path_; // a spacing between neighbours
  std::vector<Crosser> crossers_;
};
} // namespace

Line tip_ahead(const BondGraph& graph, const Line& start) { return Ahead(graph, start).tip(); }
} // namespace pdx::track
