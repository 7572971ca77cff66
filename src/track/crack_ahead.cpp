#include "crack_ahead.hpp"

#include "soft_line.hpp"

#include <algorithm>

namespace pdx::track {
namespace {
constexpr int kShort = 2;                    // square of the length of bonds that show where damage is, in spacings
constexpr Stiffness kSteadiness{5.0, 200.0}; // so that broken bonds beside the path do not lead astray
constexpr double kOnPath = 1e-6;             // spacings: a particle nearer to the path is on either side
constexpr double kEqual = 1e-6;              // of a weight

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

class WayAhead {
public:
  WayAhead(const BondGraph& graph, const Line& start)
      : graph_(graph), start_(start), horizon_(graph.horizon() / graph.lattice().dx), path_{start.at}
  {}

  Ahead find()
  {
    Vector<2> along = start_.along;
    for (int quiet = 0; quiet < patience() && along.dot(start_.along) > 0.0;) quiet = step(along) ? 0 : quiet + 1;
    const double place = last_half();
    if (place == 0.0) return {start_, {start_.at}, 0.0};
    const Vector<2> at = point(place);
    Ahead ahead{{at, (at - point(place - horizon_)).normalized()}, {}, share_};
    for (std::size_t k = 0; static_cast<double>(k) < place; ++k) ahead.way.push_back(path_[k]);
    ahead.way.push_back(at);
    return ahead;
  }

private:
  /// Steps without damage after which there is none.
  int patience() const { return static_cast<int>(std::ceil(horizon_)) + 1; }

  /// Goes on by one spacing. Is at least half of what crosses it broken?
  bool step(Vector<2>& along)
  {
    const Vector<2> from = path_.back();
    const Line line = soft_line(ends_ahead({from, along}), {from, along}, kSteadiness);
    const Vector<2> to = from + (line.at + line.along - from).normalized();
    along = line.along;
    path_.push_back(to);
    return pass(from, to, static_cast<double>(path_.size()) - 2.0);
  }

  /// Ends of broken short bonds beside the way straight on, the higher one as left of the crack.
  std::vector<Labelled> ends_ahead(const Line& straight) const
  {
    std::vector<Labelled> all;
    for_each_site(straight.at, straight.at + horizon_ * straight.along, 2.0, [&](const Site<2>& site) {
      for (std::size_t h = 0; h < graph_.stencil().half.size(); ++h) {
        const Site<2>& arm = graph_.stencil().half[h].step;
        if (arm[0] * arm[0] + arm[1] * arm[1] > kShort || !graph_.gone(site, h)) continue;
        const Vector<2> a = middle_of(site), b = middle_of(graph_.end_of(site, h)), middle = 0.5 * (a + b);
        const double place = straight.along.dot(middle - straight.at), rise = straight.offset(b) - straight.offset(a);
        const double weight = fade(-place, 0.0, 1.0) * fade(place, 0.5 * horizon_, horizon_) *
                              fade(std::abs(straight.offset(middle)), 1.0, 2.0) * std::min(std::abs(rise), 1.0);
        if (weight == 0.0) continue;
        const double side = rise > 0.0 ? 1.0 : -1.0;
        all.push_back({a, -side, weight});
        all.push_back({b, side, weight});
      }
    });
    return all;
  }

  /// Notes the bonds that cross a piece of the path. Is at least half of their weight gone?
  bool pass(const Vector<2>& a, const Vector<2>& b, double place)
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

  /// Where the share falls below one half for good: most of what is broken lies before, most of the rest behind.
  double last_half()
  {
    std::ranges::sort(crossers_, {}, &Crosser::place);
    double excess = 0.0, most = 0.0, first = 0.0, last = 0.0, nearest[] = {0.0, 0.0};
    for (std::size_t k = 0; k < crossers_.size(); ++k) {
      if (crossers_[k].place <= horizon_) nearest[crossers_[k].gone] += crossers_[k].weight;
      excess += crossers_[k].gone ? crossers_[k].weight : -crossers_[k].weight;
      if (excess < most - kEqual * crossers_[k].weight) continue;
      const double next = k + 1 < crossers_.size() ? crossers_[k + 1].place : static_cast<double>(path_.size() - 1);
      if (excess > most + kEqual * crossers_[k].weight) first = crossers_[k].place;
      most = std::max(most, excess);
      last = next;
    }
    share_ = nearest[1] / (nearest[0] + nearest[1]);
    return most > 0.0 ? 0.5 * (first + last) : 0.0;
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
  double share_ = 0.0;
};
} // namespace

Ahead tip_ahead(const BondGraph& graph, const Line& start) { return WayAhead(graph, start).find(); }
} // namespace pdx::track
