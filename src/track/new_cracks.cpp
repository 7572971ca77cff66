#include "pdx/track/new_cracks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

namespace pdx::track {
namespace new_crack {
constexpr Index kNear = 2;          // neighbours as CrackTree takes them
constexpr double kOutermost = 0.75; // of a spacing: particles of the outermost row

/// Which of some things hang together.
class Pieces {
public:
  explicit Pieces(std::size_t count) : root_(count) { std::iota(root_.begin(), root_.end(), std::size_t{0}); }
  std::size_t of(std::size_t k)
  {
    while (root_[k] != k) k = root_[k] = root_[root_[k]];
    return k;
  }
  void join(std::size_t a, std::size_t b) { root_[of(a)] = of(b); }

private:
  std::vector<std::size_t> root_;
};

struct Spot {
  Vector<2> at;
  std::vector<std::size_t> near;
  const TreeGround* ground;
};

std::vector<Spot> spots_of(std::span<const Arrival> arrivals, std::span<const TreeGround> grounds)
{
  std::vector<Spot> spots;
  std::unordered_map<std::uint64_t, std::size_t> number;
  for (std::size_t k = 0; k < arrivals.size(); ++k) number[arrivals[k].site] = k;
  for (const Arrival& arrival : arrivals) {
    Spot spot{Vector<2>::Zero(), {}, nullptr};
    for (const TreeGround& ground : grounds) {
      const auto site = ground.names.site(arrival.site);
      if (spot.ground || !site) continue;
      spot.ground = &ground;
      spot.at = ground.where.lattice.point(*site);
      for (Index i = -kNear; i <= kNear; ++i)
        for (Index j = -kNear; j <= kNear; ++j) {
          if (i * i + j * j > kNear * kNear + 1) continue;
          const auto other = number.find(ground.names.of({(*site)[0] + i, (*site)[1] + j}));
          if (other != number.end()) spot.near.push_back(other->second);
        }
    }
    if (!spot.ground) throw std::logic_error("damage came to a particle of no lattice");
    spots.push_back(std::move(spot));
  }
  return spots;
}

/// Distance to the sides left, right, bottom, top [m].
std::array<double, 4> depths(const geom::Box<2>& body, const Vector<2>& x)
{
  return {x[0] - body.lower[0], body.upper[0] - x[0], x[1] - body.lower[1], body.upper[1] - x[1]};
}

/// On the side that most of the particles of a piece of the border lie at.
CrackStart mouth_of(const geom::Box<2>& body, std::span<const Spot> spots, std::span<const std::size_t> piece)
{
  std::array<std::size_t, 4> votes{};
  Vector<2> middle = Vector<2>::Zero();
  for (const std::size_t k : piece) {
    const auto depth = depths(body, spots[k].at);
    for (std::size_t side = 0; side < 4; ++side)
      votes[side] += depth[side] < kOutermost * spots[k].ground->where.lattice.dx;
    middle += spots[k].at / static_cast<double>(piece.size());
  }
  const auto side = static_cast<std::size_t>(std::ranges::max_element(votes) - votes.begin());
  const auto d = static_cast<Eigen::Index>(side / 2);
  CrackStart start{middle, Vector<2>::Zero()};
  start.at[d] = side % 2 ? body.upper[d] : body.lower[d];
  start.direction[d] = side % 2 ? -1.0 : 1.0;
  return start;
}

/// Of damage that reaches no border.
CrackStart end_of(std::span<const Spot> spots, std::span<const std::size_t> piece)
{
  Vector<2> middle = Vector<2>::Zero();
  for (const std::size_t k : piece) middle += spots[k].at / static_cast<double>(piece.size());
  const auto far = std::ranges::max_element(piece, {}, [&](std::size_t k) { return (spots[k].at - middle).norm(); });
  const Vector<2> along = middle - spots[*far].at;
  return {spots[*far].at, along.norm() > 0.0 ? Vector<2>(along.normalized()) : Vector<2>(Vector<2>::UnitX())};
}

using Groups = std::map<std::size_t, std::vector<std::size_t>>;

/// Numbers by the piece they belong to, joined with what is near of those that `takes` takes.
template <class Takes> Groups grouped(std::span<const Spot> spots, Takes&& takes)
{
  Pieces pieces(spots.size());
  for (std::size_t k = 0; k < spots.size(); ++k)
    for (const std::size_t other : spots[k].near)
      if (takes(k) && takes(other)) pieces.join(k, other);
  Groups groups;
  for (std::size_t k = 0; k < spots.size(); ++k)
    if (takes(k)) groups[pieces.of(k)].push_back(k);
  return groups;
}
} // namespace new_crack

std::vector<CrackStart> new_starts(std::span<const Arrival> arrivals, std::span<const TreeGround> grounds,
                                   const geom::Box<2>& body, std::span<const CrackStart> given)
{
  using namespace new_crack;
  const std::vector<Spot> spots = spots_of(arrivals, grounds);
  std::vector<std::uint8_t> is_new(spots.size(), 1);
  const auto hangs = [&](const Spot& spot) {
    const double reach = spot.ground->horizon + 2.0 * spot.ground->where.lattice.dx;
    return std::ranges::any_of(given, [&](const CrackStart& tip) { return (tip.at - spot.at).norm() <= reach; });
  };
  const Groups all = grouped(spots, [](std::size_t) { return true; });
  for (const auto& [root, group] : all)
    if (std::ranges::any_of(group, [&](std::size_t k) { return hangs(spots[k]); }))
      for (const std::size_t k : group) is_new[k] = 0;
  const auto at_border = [&](std::size_t k) {
    const auto depth = depths(body, spots[k].at);
    return is_new[k] && *std::ranges::min_element(depth) < kOutermost * spots[k].ground->where.lattice.dx;
  };
  std::vector<CrackStart> starts;
  for (const auto& [root, piece] : grouped(spots, at_border)) starts.push_back(mouth_of(body, spots, piece));
  for (const auto& [root, group] : all)
    if (is_new[group[0]] && std::ranges::none_of(group, at_border)) starts.push_back(end_of(spots, group));
  std::ranges::sort(starts, {}, [](const CrackStart& s) { return std::pair(s.at[0], s.at[1]); });
  return starts;
}

std::vector<GrownTip> new_cracks(std::vector<Arrival> arrivals, std::vector<TreeGround> grounds,
                                 const geom::Box<2>& body, std::span<const CrackStart> given)
{
  std::vector<CrackStart> starts = new_starts(arrivals, grounds, body, given);
  const std::size_t count = starts.size();
  starts.insert(starts.end(), given.begin(), given.end());
  double reach = 0.0;
  for (const TreeGround& ground : grounds) reach = std::max(reach, ground.horizon);
  CrackTree tree(std::move(starts), std::move(grounds));
  std::ranges::sort(arrivals, {}, [](const Arrival& a) { return std::pair(a.time, a.site); });
  tree.add(std::move(arrivals));
  std::vector<GrownTip> tips = tree.tips();
  std::erase_if(tips, [&](const GrownTip& tip) { return tip.start >= count; });
  for (GrownTip& tip : tips) { // a tree's paths all begin when the first of them did
    if (tip.path.size() < 2) continue;
    PathPoint& mouth = tip.path.front();
    mouth.time = tip.path[1].time;
    for (const Arrival& arrival : tree.arrivals())
      if ((*tree.place(arrival.site) - mouth.at).norm() <= reach) mouth.time = std::min(mouth.time, arrival.time);
  }
  return tips;
}
} // namespace pdx::track
