#include "pdx/track/crack_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <set>
#include <stdexcept>
#include <utility>

namespace pdx::track {
namespace {
constexpr double kBranch = 2.0;        // horizons that a branch must be long
constexpr double kSpan = 4.0;          // horizons over which speeds are taken
constexpr Index kReach = 2;            // neighbours: up to two spacings along one axis and one along the other
constexpr double kTreeRounding = 1e-6; // of a spacing: distances this near are equal
constexpr double kSameTime = 1e-9;     // of the time itself
} // namespace

/// Points that grow together when they come in from the farthest to the nearest; each group knows its farthest.
class CrackTree::Groups {
public:
  explicit Groups(std::size_t points) : root_(points, -1), front_(points, -1) {}
  bool has(int point) const { return root_[static_cast<std::size_t>(point)] >= 0; }
  void open(int point) { at(point) = point; }
  int root(int point)
  {
    while (at(point) != point) point = at(point) = at(at(point));
    return point;
  }
  void join(int a, int b) { at(root(a)) = root(b); }
  int& front(int root) { return front_[static_cast<std::size_t>(root)]; } ///< number of the farthest, by root

private:
  int& at(int point) { return root_[static_cast<std::size_t>(point)]; }
  std::vector<int> root_, front_;
};

CrackTree::CrackTree(std::vector<CrackStart> starts, std::vector<TreeGround> grounds)
    : starts_(std::move(starts)), grounds_(std::move(grounds))
{
  for (const CrackStart& start : starts_) {
    const auto holds = [&](const TreeGround& ground) {
      return geom::covers(ground.where, start.at, kTreeRounding * ground.where.lattice.dx);
    };
    const auto found = std::ranges::find_if(grounds_, holds);
    start_ground_.push_back(found == grounds_.end() ? -1 : static_cast<int>(found - grounds_.begin()));
  }
}

std::optional<CrackTree::Seat> CrackTree::seat(std::uint64_t site) const
{
  for (const TreeGround& ground : grounds_)
    if (const auto found = ground.names.site(site)) return Seat{&ground, *found};
  return std::nullopt;
}

std::optional<Vector<2>> CrackTree::place(std::uint64_t site) const
{
  const std::optional<Seat> found = seat(site);
  if (!found) return std::nullopt;
  return found->ground->where.lattice.point(found->site);
}

double CrackTree::equal(const Point& point) const
{
  const int ground = point.start < 0 ? -1 : start_ground_[static_cast<std::size_t>(point.start)];
  return ground < 0 ? 0.0 : kTreeRounding * grounds_[static_cast<std::size_t>(ground)].where.lattice.dx;
}

double CrackTree::span(std::size_t start) const
{
  const int ground = start_ground_[start];
  return ground < 0 ? 0.0 : kSpan * grounds_[static_cast<std::size_t>(ground)].horizon;
}

/// Points within a horizon of a start hang on it; what is behind it has a negative distance.
void CrackTree::seed(Point& point, const TreeGround& ground)
{
  const double equal = kTreeRounding * ground.where.lattice.dx;
  double nearest = ground.horizon + 2.0 * ground.where.lattice.dx + 2.0 * equal;
  for (std::size_t s = 0; s < starts_.size(); ++s) {
    const Vector<2> from = point.at - starts_[s].at;
    if (start_ground_[s] < 0 || from.norm() > nearest - equal) continue; // equally near: the first
    nearest = from.norm();
    const double ahead = starts_[s].direction.dot(from);
    point.start = static_cast<int>(s);
    point.distance = ahead > equal ? nearest : ahead;
  }
  if (point.start >= 0) start_time_ = std::min(start_time_.value_or(point.time), point.time);
}

int CrackTree::insert(const Arrival& arrival)
{
  const std::optional<Seat> found = seat(arrival.site);
  if (!found) throw std::logic_error("damage came to a particle of no lattice");
  const auto& [where, horizon, names] = *found->ground;
  const Site<2> site = found->site;
  const int number = static_cast<int>(points_.size());
  Point point;
  point.at = where.lattice.point(site);
  point.time = arrival.time;
  for (Index i = -kReach; i <= kReach; ++i)
    for (Index j = -kReach; j <= kReach; ++j) {
      const Site<2> other{site[0] + i, site[1] + j};
      if (i * i + j * j > kReach * kReach + 1 || (!i && !j)) continue;
      const std::uint64_t name = names.of(other);
      const auto known = point_of_.find(name);
      if (known == point_of_.end() || names.site(name) != other) continue; // beyond an end of its row
      point.near.push_back(known->second);
      points_[static_cast<std::size_t>(known->second)].near.push_back(number);
    }
  seed(point, *found->ground);
  point_of_[arrival.site] = number;
  arrivals_.push_back(arrival);
  points_.push_back(std::move(point));
  return number;
}

void CrackTree::add(std::vector<Arrival> arrivals)
{
  std::ranges::sort(arrivals, {}, &Arrival::site);
  std::vector<int> open = std::move(loose_);
  loose_.clear();
  for (const Arrival& arrival : arrivals) open.push_back(insert(arrival));
  link(open);
}

/// Shortest chains to the open points from those that hang on a start, whose own chains stay as they are.
void CrackTree::link(const std::vector<int>& open)
{
  using Reached = std::pair<double, int>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> queue;
  std::vector<char> done(points_.size(), 1);
  for (const int p : open) done[static_cast<std::size_t>(p)] = 0;
  const auto reach = [&](int p, int from) {
    Point& point = points_[static_cast<std::size_t>(p)];
    const Point& before = points_[static_cast<std::size_t>(from)];
    const double distance = before.distance + (point.at - before.at).norm();
    if (point.start >= 0) {
      if (point.parents.empty() || distance > point.distance + equal(point)) return;
      if (distance >= point.distance - equal(point)) {
        if (before.start == point.start) point.parents.push_back(from);
        return;
      }
    }
    point.start = before.start;
    point.parents = {from};
    point.distance = distance;
    queue.emplace(distance, p);
  };
  for (const int p : open) {
    if (points_[static_cast<std::size_t>(p)].start >= 0)
      queue.emplace(points_[static_cast<std::size_t>(p)].distance, p);
    for (const int from : points_[static_cast<std::size_t>(p)].near)
      if (done[static_cast<std::size_t>(from)] && points_[static_cast<std::size_t>(from)].start >= 0) reach(p, from);
  }
  while (!queue.empty()) {
    const auto [distance, p] = queue.top();
    queue.pop();
    if (done[static_cast<std::size_t>(p)]) continue;
    done[static_cast<std::size_t>(p)] = 1;
    for (const int q : points_[static_cast<std::size_t>(p)].near)
      if (!done[static_cast<std::size_t>(q)]) reach(q, p);
  }
  for (const int p : open)
    if (points_[static_cast<std::size_t>(p)].start < 0) loose_.push_back(p);
}

/// Those of a start, equally far ones together.
std::vector<std::vector<int>> CrackTree::farthest_first(int start) const
{
  std::vector<int> order;
  for (std::size_t p = 0; p < points_.size(); ++p)
    if (points_[p].start == start) order.push_back(static_cast<int>(p));
  const auto point = [&](int p) -> const Point& { return points_[static_cast<std::size_t>(p)]; };
  std::ranges::sort(order, std::greater<>(), [&](int p) { return point(p).distance; });
  std::vector<std::vector<int>> rings;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || point(order[k]).distance < point(order[k - 1]).distance - equal(point(order[k])))
      rings.emplace_back();
    rings.back().push_back(order[k]);
  }
  for (std::vector<int>& ring : rings) std::ranges::sort(ring);
  return rings;
}

/// Longer, or as long and there before.
bool CrackTree::beats(const Front& a, const Front& b) const
{
  const double same = equal(points_[static_cast<std::size_t>(a.points[0])]);
  if (std::abs(a.distance - b.distance) > same) return a.distance > b.distance;
  if (std::abs(a.time - b.time) > kSameTime * std::max(a.time, b.time)) return a.time < b.time;
  return a.points[0] < b.points[0];
}

PathPoint CrackTree::middle(std::span<const int> points) const
{
  PathPoint sum;
  for (const int p : points) {
    sum.at += points_[static_cast<std::size_t>(p)].at;
    sum.time += points_[static_cast<std::size_t>(p)].time;
  }
  const auto count = static_cast<double>(points.size());
  return {sum.time / count, sum.at / count};
}

CrackTree::Way CrackTree::way_to(const Front& front) const
{
  const auto point = [&](int p) -> const Point& { return points_[static_cast<std::size_t>(p)]; };
  std::vector<char> seen(points_.size(), 0);
  std::vector<int> all = front.points;
  for (const int p : all) seen[static_cast<std::size_t>(p)] = 1;
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const int q : point(all[k]).parents)
      if (!std::exchange(seen[static_cast<std::size_t>(q)], 1)) all.push_back(q);
  std::ranges::sort(all, std::greater<>(), [&](int p) { return point(p).distance; });
  Way way;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    for (end = begin + 1; end < all.size(); ++end)
      if (point(all[end]).distance < point(all[end - 1]).distance - equal(point(all[end]))) break;
    way.distance.push_back(point(all[begin]).distance);
    way.path.push_back(middle(std::span(all).subspan(begin, end - begin)));
  }
  return way;
}

GrownTip CrackTree::tip_at(const Front& front) const
{
  GrownTip tip;
  tip.start = static_cast<std::size_t>(points_[static_cast<std::size_t>(front.points[0])].start);
  tip.length = std::max(0.0, front.distance);
  tip.own = tip.length;
  tip.at = middle(front.points).at; // a crack between two rows ends between them
  tip.path = way_to(front).path;
  tip.path.push_back({std::min(tip.path.back().time, start_time_.value_or(0.0)), starts_[tip.start].at});
  std::ranges::reverse(tip.path);
  return tip;
}

/// When the chains to a front were at a distance from the start.
double CrackTree::passed(const Front& front, double distance) const
{
  const Way way = way_to(front);
  const double same = equal(points_[static_cast<std::size_t>(front.points[0])]);
  for (std::size_t k = 0; k < way.path.size(); ++k)
    if (way.distance[k] <= distance + same) return way.path[k].time;
  return way.path.back().time;
}

GrownTip CrackTree::branch_at(const Meeting& meeting) const
{
  const double distance = points_[static_cast<std::size_t>(meeting.points[0])].distance;
  GrownTip tip = tip_at(meeting.branch);
  tip.own = meeting.branch.distance - distance;
  tip.branched = PathPoint{std::min(passed(meeting.branch, distance), passed(meeting.longer, distance)),
                           middle(meeting.points).at};
  return tip;
}

/// Points come in from the farthest to the nearest, equally far ones at once; where groups meet, the shorter ones are
/// branches if they are long enough by then.
std::vector<GrownTip> CrackTree::tips_of(int start) const
{
  const auto point = [&](int p) -> const Point& { return points_[static_cast<std::size_t>(p)]; };
  const double least = kBranch / kSpan * span(static_cast<std::size_t>(start));
  Groups groups(points_.size());
  std::vector<Front> fronts;
  std::vector<GrownTip> tips, branches;
  for (const std::vector<int>& ring : farthest_first(start)) {
    const double distance = point(ring[0]).distance;
    std::vector<std::pair<int, int>> met; // point of the ring, front
    for (const int p : ring)
      for (const int q : point(p).near)
        if (groups.has(q)) met.emplace_back(p, groups.front(groups.root(q)));
    for (const int p : ring) groups.open(p);
    for (const int p : ring)
      for (const int q : point(p).near)
        if (groups.has(q)) groups.join(q, p);
    std::map<int, std::vector<int>> joined; // points of the ring, by group
    for (const int p : ring) joined[groups.root(p)].push_back(p);
    std::map<int, std::set<int>> brought; // fronts, by group
    for (const auto& [p, front] : met) brought[groups.root(p)].insert(front);
    for (const auto& [root, points] : joined) {
      const std::set<int>& own = brought[root];
      if (own.empty()) {
        groups.front(root) = static_cast<int>(fronts.size());
        const double first = point(*std::ranges::min_element(points, {}, [&](int p) { return point(p).time; })).time;
        fronts.push_back({points, distance, first});
        continue;
      }
      const auto of = [&](int front) -> const Front& { return fronts[static_cast<std::size_t>(front)]; };
      const int longest = *std::ranges::min_element(own, [&](int a, int b) { return beats(of(a), of(b)); });
      groups.front(root) = longest;
      for (const int front : own)
        if (front != longest && of(front).distance - distance >= least - equal(point(ring[0])))
          branches.push_back(branch_at({of(front), of(longest), points}));
    }
  }
  // What hangs on the start apart from the longest is a crack of its own once it is long enough.
  std::set<int> whole;
  for (const Front& front : fronts) whole.insert(groups.front(groups.root(front.points[0])));
  const auto of = [&](int front) -> const Front& { return fronts[static_cast<std::size_t>(front)]; };
  if (whole.empty()) return {};
  const int first = *std::ranges::min_element(whole, [&](int a, int b) { return beats(of(a), of(b)); });
  for (const int front : whole)
    if (front == first || of(front).distance >= least - equal(point(of(front).points[0])))
      tips.push_back(tip_at(of(front)));
  std::ranges::move(branches, std::back_inserter(tips));
  std::vector<std::pair<double, std::size_t>> order; // of equal ones a branch comes behind
  for (std::size_t t = 0; t < tips.size(); ++t)
    order.emplace_back(-std::round(tips[t].length / equal(point(of(first).points[0]))), t);
  std::ranges::sort(order);
  std::vector<GrownTip> sorted;
  for (const auto& [length, t] : order) sorted.push_back(std::move(tips[t]));
  return sorted;
}

std::vector<GrownTip> CrackTree::tips() const
{
  std::vector<GrownTip> all;
  for (std::size_t s = 0; s < starts_.size(); ++s) {
    std::vector<GrownTip> mine = tips_of(static_cast<int>(s));
    if (mine.empty()) {
      mine.emplace_back();
      mine.back().start = s;
      mine.back().at = starts_[s].at;
    }
    std::ranges::move(mine, std::back_inserter(all));
  }
  return all;
}

double tip_speed(const GrownTip& tip, double span, double now, double look)
{
  const double least = span * (1.0 - kTreeRounding);
  if (tip.path.empty() || tip.length < least) return 0.0;
  const Vector<2> end = tip.path.back().at;
  std::size_t first = tip.path.size() - 1;
  while (first > 0 && (tip.path[first].at - end).norm() < least) --first;
  const Vector<2> way = (end - tip.path[first].at).normalized();
  double time = 0.0, place = 0.0;
  const auto count = static_cast<double>(tip.path.size() - first);
  for (std::size_t k = first; k < tip.path.size(); ++k) {
    time += tip.path[k].time / count;
    place += way.dot(tip.path[k].at) / count;
  }
  double over = 0.0, under = 0.0;
  for (std::size_t k = first; k < tip.path.size(); ++k) {
    over += (tip.path[k].time - time) * (way.dot(tip.path[k].at) - place);
    under += std::pow(tip.path[k].time - time, 2);
  }
  if (under <= 0.0) return 0.0;
  const double waits = now - tip.path.back().time - look;
  const double slope = over / under;
  return waits > 0.0 ? std::min(slope, span / waits) : slope;
}
} // namespace pdx::track
