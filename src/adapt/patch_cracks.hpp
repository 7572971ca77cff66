#pragma once
#include "pdx/adapt/crack_paths.hpp"
#include "pdx/adapt/patch_map.hpp"
#include "pdx/geom/polygon.hpp"
#include "pdx/track/follow.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace pdx::adapt {
inline constexpr std::size_t kLeastRun = 2; // elements that carry a crack which they had nothing of
inline constexpr double kSliver = 0.05;     // of a cell's area

/// A crack that was followed through a patch.
struct Trail {
  std::size_t crack = 0;
  bool last = false; // from the crack's last point on
  track::Followed found;
  std::optional<Vector<2>> other_tip; // of a crack that elements have nothing of yet
  crack::Polyline corners() const
  {
    crack::Polyline all;
    for (const track::Crossing& crossing : found.crossings) all.push_back(crossing.out);
    return all;
  }
};

/// One patch with its cracks.
class PatchCracks {
public:
  PatchCracks(const SceneView& scene, const PatchMap& map, std::size_t patch, track::Tracker tracker)
      : tracker_(tracker), shape_(scene.around[patch].shape()),
        graph_(shape_.lattice, scene.bonds.parts()[patch]->stencil(),
               [&shape = shape_](const Site<2>& site) { return shape.active.has(site); })
  {
    for (const PatchMap::Cell& cell : map.cells)
      if (static_cast<std::size_t>(cell.patch) == patch) {
        cells_.push_back(cell.box);
        numbers_.push_back(cell.number);
      }
    for (const PatchMap::Damaged& particle : map.damaged) {
      if (static_cast<std::size_t>(particle.patch) != patch) continue;
      graph_.add(particle.site, particle.gone);
      damaged_.push_back(&particle);
    }
    for (const crack::Tip& tip : scene.sets->cracks().tips())
      if (shape_.holds(tip.at, kFits * shape_.lattice.dx))
        trails_.push_back({static_cast<std::size_t>(tip.crack), tip.last,
                           track::follow(graph_, cells_, tip.at, tip.direction, tracker_), std::nullopt});
  }

  /// A crack that begins or branches in this patch, and is none of the paths that are known: from the damage farthest
  /// from these on. @param reach of the tips that are known, where nothing is handed back [m]
  /// @param taken natural numbers of cells that trails go through: its own are added
  std::optional<Trail> unknown(std::span<const crack::Polyline> paths, double reach, std::set<Index>& taken)
  {
    const auto near_tip = [&](const geom::Box<2>& cell) {
      return std::ranges::any_of(trails_, [&](const Trail& trail) { return distance(cell, trail.found.tip) < reach; });
    };
    const std::vector<std::pair<Vector<2>, double>> far = unclaimed(paths);
    std::vector<std::pair<double, std::size_t>> candidates; // less the distance, cell
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      double farthest = 0.0;
      for (const auto& [x, away] : far)
        if (cells_[c].contains(x)) farthest = std::max(farthest, away);
      if (farthest > 0.0 && !tried_.contains(c) && !near_tip(cells_[c])) candidates.push_back({-farthest, c});
    }
    std::ranges::sort(candidates);
    for (const auto& [less, c] : candidates) {
      tried_.insert(c);
      auto found = track::follow_both_ways(graph_, cells_, c, tracker_);
      if (!found) continue;
      Trail trail{0, true, std::move(found->ahead), found->tip_behind};
      const auto here = std::ranges::find(trail.found.crossings, c, &track::Crossing::cell);
      keep_what_is_free(trail, static_cast<std::size_t>(here - trail.found.crossings.begin()), taken);
      if (trail.found.crossings.size() >= kLeastRun) return trail;
    }
    return std::nullopt;
  }
  void add(Trail trail) { trails_.push_back(std::move(trail)); }

  /// Does a crossing clip so little of its cell that the nodes there would lean on next to nothing at a crack's end?
  bool is_sliver(const track::Crossing& crossing) const
  {
    const geom::Box<2>& cell = cells_[crossing.cell];
    const std::array<Vector<2>, 4> corners{cell.lower, Vector<2>(cell.upper[0], cell.lower[1]), cell.upper,
                                           Vector<2>(cell.lower[0], cell.upper[1])};
    const Vector<2> along = crossing.out - crossing.in;
    std::array<double, 4> distance;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector<2> to = corners[k] - crossing.in;
      distance[k] = along.x() * to.y() - along.y() * to.x();
    }
    const geom::Split parts = geom::split(corners, distance);
    if (parts.minus.empty() || parts.plus.empty()) return false; // along a side
    return std::min(geom::area(parts.minus), geom::area(parts.plus)) < kSliver * geom::area(corners);
  }

  std::span<const geom::Box<2>> cells() const { return cells_; }
  std::span<const Index> numbers() const { return numbers_; }
  std::span<const Trail> trails() const { return trails_; }
  std::span<Trail> trails() { return trails_; }
  /// Leaves of a trail what goes from one of its crossings, both ways, up to cells that others have taken, and takes
  /// it.
  void keep_what_is_free(Trail& trail, std::size_t here, std::set<Index>& taken) const
  {
    const std::vector<track::Crossing>& all = trail.found.crossings;
    const auto is_free = [&](std::size_t k) { return !taken.contains(numbers_[all[k].cell]); };
    std::size_t first = here, end = here;
    while (first > 0 && here < all.size() && is_free(first - 1)) --first;
    while (end < all.size() && is_free(end)) ++end;
    if (first > 0 && first < end) trail.other_tip = all[first - 1].out;
    if (end < all.size()) trail.found.tip = all[end].in;
    trail.found.crossings =
        std::vector(all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(end));
    for (const track::Crossing& crossing : trail.found.crossings) taken.insert(numbers_[crossing.cell]);
  }
  double horizon() const { return graph_.stencil().horizon; }

  /// What elements keep away from: tips, and damage that belongs to no crack that is known. @param paths of all cracks
  std::vector<Vector<2>> tips(std::span<const crack::Polyline> paths) const
  {
    std::vector<Vector<2>> tips;
    for (const Trail& trail : trails_) {
      tips.push_back(trail.found.tip);
      if (trail.other_tip) tips.push_back(*trail.other_tip);
    }
    for (const auto& [x, away] : unclaimed(paths)) tips.push_back(x);
    return tips;
  }

  /// Does damage lead on behind a crack that elements have nothing of, to where one that they have goes on?
  bool branches_off(const Trail& trail) const
  {
    return trail.other_tip && std::ranges::any_of(trails_, [&](const Trail& known) {
             if (known.other_tip) return false;
             const Vector<2> begin = known.found.crossings.empty() ? known.found.tip : known.found.crossings.front().in;
             return (begin - *trail.other_tip).norm() < 2.0 * horizon();
           });
  }

  /// Does a crack come by that was followed no farther than by broken bonds? Some that hold may make one body of it.
  bool has_way_ahead(const geom::Box<2>& cell) const
  {
    return std::ranges::any_of(trails_, [&](const Trail& trail) {
      return std::ranges::any_of(trail.found.beyond, [&](const Vector<2>& x) { return distance(cell, x) < horizon(); });
    });
  }

  /// The cell on the other side of a crack that runs along a side of the cell that it counts to.
  std::optional<std::size_t> across(const track::Crossing& crossing) const
  {
    const Vector<2> middle = 0.5 * (crossing.in + crossing.out), along = crossing.out - crossing.in;
    const Vector<2> there = middle + 1e-3 * Vector<2>(-along.y(), along.x()); // on its left
    if (cells_[crossing.cell].contains(there)) return std::nullopt;
    const auto found =
        std::ranges::find_if(cells_, [&there](const geom::Box<2>& cell) { return cell.contains(there); });
    return found == cells_.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - cells_.begin()));
  }

  /// Where particles are damaged in some of the cells.
  std::vector<Vector<2>> damaged_in(const std::function<bool(Index number)>& some) const
  {
    std::vector<Vector<2>> found;
    for (std::size_t c = 0; c < cells_.size(); ++c)
      if (some(numbers_[c]))
        for (const PatchMap::Damaged* particle : damaged_)
          if (particle->damage > kBroken && cells_[c].contains(particle->x)) found.push_back(particle->x);
    return found;
  }

  /// Is everything in a cell and a horizon around it held together but for the paths of cracks?
  /// @param lines of the paths
  bool is_parted_by(const crack::CrackSet& paths, std::span<const crack::Polyline> lines,
                    const geom::Box<2>& cell) const
  {
    const Vector<2> more = Vector<2>::Constant(horizon());
    const geom::Box<2> window{cell.lower - more, cell.upper + more};
    if (std::ranges::none_of(damaged_, [&](const auto* particle) { return window.contains(particle->x); })) return true;
    const track::Bodies bodies = track::bodies_in(graph_, window);
    const std::map<Site<2>, int> side = sides_of(paths, bodies.sites);
    return track::are_sides(
        bodies, graph_, [&](const Vector<2>& x) { return side.at(site_at(x)); },
        [&](const Vector<2>& x) { return distance(lines, x); }, shape_.lattice.dx);
  }

private:
  /// Where particles are that a crack came by which is none of the paths, and how far from these. [m]
  std::vector<std::pair<Vector<2>, double>> unclaimed(std::span<const crack::Polyline> paths) const
  {
    std::vector<std::pair<Vector<2>, double>> far;
    for (const PatchMap::Damaged* particle : damaged_) {
      if (particle->damage <= kGrown) continue;
      const double away = distance(paths, particle->x);
      if (away > 2.0 * horizon()) far.emplace_back(particle->x, away);
    }
    return far;
  }

  Site<2> site_at(const Vector<2>& x) const
  {
    const Vector<2> line = (x - shape_.lattice.origin) / shape_.lattice.dx;
    return {static_cast<Index>(std::floor(line[0])), static_cast<Index>(std::floor(line[1]))};
  }

  /// Which sites hang together by neighbours that no path parts.
  std::map<Site<2>, int> sides_of(const crack::CrackSet& paths, std::span<const Site<2>> sites) const
  {
    std::map<Site<2>, int> side;
    for (const Site<2>& site : sites) side[site] = -1;
    int count = 0;
    for (const Site<2>& start : sites) {
      if (side[start] >= 0) continue;
      std::vector<Site<2>> open{start};
      side[start] = count;
      while (!open.empty()) {
        const Site<2> here = open.back();
        open.pop_back();
        for (const Site<2>& step : {Site<2>{1, 0}, Site<2>{-1, 0}, Site<2>{0, 1}, Site<2>{0, -1}}) {
          const auto next = side.find({here[0] + step[0], here[1] + step[1]});
          if (next == side.end() || next->second >= 0) continue;
          if (paths.cuts(shape_.lattice.point(here), shape_.lattice.point(next->first))) continue;
          next->second = count;
          open.push_back(next->first);
        }
      }
      ++count;
    }
    return side;
  }

  track::Tracker tracker_;
  const couple::PatchShape& shape_;
  track::BondGraph graph_;
  std::vector<geom::Box<2>> cells_;
  std::vector<Index> numbers_; // natural, of each of them
  std::vector<const PatchMap::Damaged*> damaged_;
  std::vector<Trail> trails_;
  std::set<std::size_t> tried_; // cells that no crack could be followed from
};
} // namespace pdx::adapt
