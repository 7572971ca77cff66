#include "pdx/post/crack_tree.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace pdx::post {
namespace {
constexpr double kBranch = 2.0; // horizons that a branch must be long
constexpr double kSpan = 4.0;   // horizons over which speeds are taken
constexpr Index kReach = 2;     // neighbours: up to two spacings along one axis and one along the other
constexpr double kRound = 1e-6; // of a spacing: distances this near are equal

/// Groups of points that grow together when points come in one by one; each group knows its farthest point.
class Groups {
public:
  explicit Groups(std::size_t points) : root_(points, -1) {}
  bool has(int point) const { return root_[static_cast<std::size_t>(point)] >= 0; }
  void open(int point) { at(point) = point; }
  int root(int point)
  {
    while (at(point) != point) point = at(point) = at(at(point));
    return point;
  }
  void join(int root, int into) { at(root) = into; }

private:
  int& at(int point) { return root_[static_cast<std::size_t>(point)]; }
  std::vector<int> root_;
};
} // namespace

CrackTree::CrackTree(std::vector<CrackStart> starts, std::vector<TreeGround> grounds)
    : starts_(std::move(starts)), grounds_(std::move(grounds))
{
  for (const CrackStart& start : starts_) {
    const auto holds = [&](const TreeGround& ground) {
      const Vector<2> from = start.at - ground.lattice.origin;
      const Vector<2> size = ground.lattice.dx * Vector<2>(ground.lattice.count[0], ground.lattice.count[1]);
      return (from.array() >= 0.0).all() && (from.array() <= size.array()).all();
    };
    const auto found = std::ranges::find_if(grounds_, holds);
    start_ground_.push_back(found == grounds_.end() ? -1 : static_cast<int>(found - grounds_.begin()));
  }
}

std::uint64_t CrackTree::key(Index patch, Index site) const
{
  return static_cast<std::uint64_t>(patch) << 32 | static_cast<std::uint32_t>(site);
}

double CrackTree::span(std::size_t start) const
{
  const int ground = start_ground_[start];
  return ground < 0 ? 0.0 : kSpan * grounds_[static_cast<std::size_t>(ground)].horizon;
}

/// Points within a horizon of a start hang on it; what is behind it has a negative distance.
void CrackTree::seed(Point& point, const TreeGround& ground)
{
  double nearest = ground.horizon + 2.0 * ground.lattice.dx;
  for (std::size_t s = 0; s < starts_.size(); ++s) {
    const Vector<2> from = point.at - starts_[s].at;
    if (start_ground_[s] < 0 || from.norm() > nearest) continue;
    nearest = from.norm();
    const double ahead = starts_[s].direction.dot(from);
    point.start = static_cast<int>(s);
    point.distance = ahead > 0.0 ? nearest : ahead;
  }
  if (point.start >= 0) start_time_ = std::min(start_time_.value_or(point.time), point.time);
}

int CrackTree::insert(const Arrival& arrival)
{
  const TreeGround& ground = grounds_[static_cast<std::size_t>(arrival.patch)];
  const Site<2> site = ground.lattice.site(arrival.site);
  const int number = static_cast<int>(points_.size());
  Point point;
  point.at = ground.lattice.point(site);
  point.time = arrival.time;
  for (Index i = -kReach; i <= kReach; ++i)
    for (Index j = -kReach; j <= kReach; ++j) {
      const Site<2> other{site[0] + i, site[1] + j};
      if (i * i + j * j > kReach * kReach + 1 || (!i && !j) || !ground.lattice.contains(other)) continue;
      const auto found = point_of_.find(key(arrival.patch, static_cast<Index>(ground.lattice.number(other))));
      if (found == point_of_.end()) continue;
      point.near.push_back(found->second);
      points_[static_cast<std::size_t>(found->second)].near.push_back(number);
    }
  seed(point, ground);
  point_of_[key(arrival.patch, arrival.site)] = number;
  arrivals_.push_back(arrival);
  points_.push_back(std::move(point));
  return number;
}

void CrackTree::add(std::vector<Arrival> arrivals)
{
  std::ranges::sort(arrivals, {}, [&](const Arrival& a) { return key(a.patch, a.site); });
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
    if (point.start >= 0 && (point.parent < 0 || distance >= point.distance)) return;
    point.start = before.start;
    point.parent = from;
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

std::vector<int> CrackTree::farthest_first(int start) const
{
  std::vector<int> order;
  for (std::size_t p = 0; p < points_.size(); ++p)
    if (points_[p].start == start) order.push_back(static_cast<int>(p));
  const auto distance = [&](int p) { return points_[static_cast<std::size_t>(p)].distance; };
  std::ranges::sort(order,
                    [&](int a, int b) { return distance(a) != distance(b) ? distance(a) > distance(b) : a < b; });
  return order;
}

GrownTip CrackTree::tip_at(int number) const
{
  GrownTip tip;
  const Point& far = points_[static_cast<std::size_t>(number)];
  tip.start = static_cast<std::size_t>(far.start);
  tip.length = std::max(0.0, far.distance);
  tip.own = tip.length;
  for (int p = number; p >= 0; p = points_[static_cast<std::size_t>(p)].parent)
    tip.path.push_back({points_[static_cast<std::size_t>(p)].time, points_[static_cast<std::size_t>(p)].at});
  tip.path.push_back({std::min(tip.path.back().time, start_time_.value_or(0.0)), starts_[tip.start].at});
  std::ranges::reverse(tip.path);

  // Neighbours that are as far share the tip: a crack between two rows ends between them.
  const double equal = kRound * grounds_[static_cast<std::size_t>(start_ground_[tip.start])].lattice.dx;
  Vector<2> sum = far.at;
  int count = 1;
  for (const int p : far.near)
    if (const Point& other = points_[static_cast<std::size_t>(p)];
        other.start == far.start && std::abs(other.distance - far.distance) <= equal) {
      sum += other.at;
      ++count;
    }
  tip.at = sum / count;
  return tip;
}

/// When the chain to a point was at a distance from the start.
double CrackTree::passed_at(int number, double distance) const
{
  const auto point = [&](int p) -> const Point& { return points_[static_cast<std::size_t>(p)]; };
  while (point(number).parent >= 0 && point(number).distance > distance) number = point(number).parent;
  return point(number).time;
}

/// Points come in from the farthest to the nearest; where two groups meet, the shorter one is a branch if it is long
/// enough by then.
std::vector<GrownTip> CrackTree::tips_of(int start) const
{
  const std::vector<int> order = farthest_first(start);
  const double least = kBranch / kSpan * span(static_cast<std::size_t>(start));
  const auto distance = [&](int p) { return points_[static_cast<std::size_t>(p)].distance; };
  Groups groups(points_.size());
  std::vector<GrownTip> tips;
  std::vector<int> whole; // first points of groups
  for (const int p : order) {
    int longest = -1;
    std::vector<int> met;
    for (const int q : points_[static_cast<std::size_t>(p)].near) {
      if (!groups.has(q)) continue;
      const int root = groups.root(q);
      if (std::ranges::find(met, root) == met.end()) met.push_back(root);
    }
    for (const int root : met)
      if (longest < 0 || distance(root) > distance(longest) || (distance(root) == distance(longest) && root < longest))
        longest = root;
    groups.open(p);
    if (longest < 0) whole.push_back(p);
    if (longest >= 0) groups.join(p, longest);
    for (const int root : met) {
      if (root == longest) continue;
      groups.join(root, longest);
      if (distance(root) - distance(p) < least) continue;
      tips.push_back(tip_at(root));
      tips.back().own = distance(root) - distance(p);
      const double passed = std::min(passed_at(longest, distance(p)), passed_at(root, distance(p)));
      tips.back().branched = PathPoint{passed, points_[static_cast<std::size_t>(p)].at};
    }
  }
  // What hangs on the start apart from the longest is a crack of its own once it is long enough.
  for (const int p : whole)
    if (groups.root(p) == p && (p == order.front() || distance(p) >= least)) tips.push_back(tip_at(p));
  std::ranges::stable_sort(tips, std::greater<>(), &GrownTip::length);
  return tips;
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
  if (tip.path.empty() || tip.length < span) return 0.0;
  const Vector<2> end = tip.path.back().at;
  std::size_t first = tip.path.size() - 1;
  while (first > 0 && (tip.path[first].at - end).norm() < span) --first;
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
} // namespace pdx::post
