#include "pdx/adapt/contraction.hpp"

#include "pdx/adapt/crack_paths.hpp"
#include "pdx/adapt/patch_map.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/track/follow.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace pdx::adapt {
namespace {
constexpr double kGrown = 0.35; // damage of particles beside a crack that has come by [-]

/// A crack that was followed through a patch.
struct Trail {
  int crack = 0;
  bool last = false; // from the crack's last point on
  track::Followed found;
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
  PatchCracks(const SceneView& scene, const PatchMap& map, std::size_t patch)
      : shape_(scene.around[patch].shape()),
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
        trails_.push_back({tip.crack, tip.last, track::follow(graph_, cells_, tip.at, tip.direction)});
  }

  std::span<const geom::Box<2>> cells() const { return cells_; }
  std::span<const Index> numbers() const { return numbers_; }
  std::span<const Trail> trails() const { return trails_; }
  double horizon() const { return graph_.stencil().horizon; }

  /// What elements keep away from: tips, and damage that belongs to no crack that is known. @param paths of all cracks
  std::vector<Vector<2>> tips(std::span<const crack::Polyline> paths) const
  {
    std::vector<Vector<2>> tips;
    for (const Trail& trail : trails_) tips.push_back(trail.found.tip);
    for (const PatchMap::Damaged* particle : damaged_)
      if (particle->damage > kGrown && distance(paths, particle->x) > 2.0 * horizon()) tips.push_back(particle->x);
    return tips;
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

  const couple::PatchShape& shape_;
  track::BondGraph graph_;
  std::vector<geom::Box<2>> cells_;
  std::vector<Index> numbers_; // natural, of each of them
  std::vector<const PatchMap::Damaged*> damaged_;
  std::vector<Trail> trails_;
};

/// All patches, and the cracks of the scene as far as they are known.
class Contraction {
public:
  Contraction(const SceneView& scene, std::span<const Retreat> reaches)
      : scene_(scene), map_(map_patches(scene)), reaches_(reaches)
  {
    for (std::size_t p = 0; p < scene.around.size(); ++p) patches_.emplace_back(scene, map_, p);
    lines_ = given();
    for (const PatchCracks& patch : patches_)
      for (const Trail& trail : patch.trails()) go_on(lines_, trail, trail.corners());
    known_ = crack::CrackSet(lines_, scene.mesh.bounds());
    to_tips_ = lines_;
    for (const PatchCracks& patch : patches_)
      for (const Trail& trail : patch.trails()) go_on(to_tips_, trail, {trail.found.tip});
    for (std::size_t p = 0; p < patches_.size(); ++p) choose(patches_[p], reaches[p].contraction);
  }

  /// Keeps what of the chosen cells energy speaks against. Collective.
  void ask(const MayHandBack& may)
  {
    const mesh::Mesh& mesh = scene_.mesh;
    std::vector<Index> against;
    for (const Index c : mesh.cells(mesh::Use::covered))
      if (may && c < mesh.owned_cells() && chosen_.contains(mesh.natural_cell(c)) && !may(c, known_))
        against.push_back(mesh.natural_cell(c));
    for (const Index number : gather_all(mesh.comm(), against)) chosen_.erase(number);
    end_trails();
    for (std::size_t p = 0; p < patches_.size(); ++p) keep_beside_unrest(patches_[p], reaches_[p].critical);
    end_trails();
  }

  LayoutChange change() const
  {
    LayoutChange change;
    if (chosen_.size() == map_.cells.size()) return change;
    for (const PatchMap::Cell& cell : map_.cells)
      if (chosen_.contains(cell.number)) change.uncover.push_back(cell.box);
    if (change.uncover.empty()) return change;
    std::vector<crack::Polyline> cracks = given();
    bool longer = false;
    for (const PatchCracks& patch : patches_)
      for (const Trail& trail : patch.trails()) {
        const crack::Polyline handed = in_elements(patch, trail);
        longer = longer || !handed.empty();
        go_on(cracks, trail, handed);
      }
    if (longer) change.cracks = std::move(cracks);
    change.paths = to_tips_;
    return change;
  }

private:
  std::vector<crack::Polyline> given() const
  {
    std::vector<crack::Polyline> cracks;
    for (int k = 0; k < scene_.sets->cracks().size(); ++k) cracks.push_back(scene_.sets->cracks().points(k));
    return cracks;
  }
  static void go_on(std::vector<crack::Polyline>& cracks, const Trail& trail, const crack::Polyline& ahead)
  {
    crack::Polyline& crack = cracks[static_cast<std::size_t>(trail.crack)];
    crack = gone_on(std::move(crack), trail.last, ahead);
  }

  void choose(const PatchCracks& patch, double reach)
  {
    const std::vector<Vector<2>> tips = patch.tips(to_tips_);
    if (tips.empty()) return;
    for (std::size_t c = 0; c < patch.cells().size(); ++c) {
      const geom::Box<2>& cell = patch.cells()[c];
      const auto far = [&](const Vector<2>& tip) { return distance(cell, tip) > (1.0 + kSame) * reach; };
      if (!std::ranges::all_of(tips, far)) continue;
      far_.insert(patch.numbers()[c]);
      if (patch.is_parted_by(known_, lines_, cell)) chosen_.insert(patch.numbers()[c]);
    }
  }

  /// Where damaged particles stay far behind the tips, what breaks there yet must not reach elements beside the crack.
  void keep_beside_unrest(const PatchCracks& patch, double critical)
  {
    const std::vector<Vector<2>> unrest =
        patch.damaged_in([&](Index cell) { return far_.contains(cell) && !chosen_.contains(cell); });
    std::set<std::size_t> crossed;
    for (const Trail& trail : patch.trails())
      for (const track::Crossing& crossing : trail.found.crossings) crossed.insert(crossing.cell);
    for (std::size_t c = 0; c < patch.cells().size(); ++c)
      if (!crossed.contains(c) && std::ranges::any_of(unrest, [&](const Vector<2>& x) {
            return distance(patch.cells()[c], x) < (1.0 + kSame) * critical;
          }))
        chosen_.erase(patch.numbers()[c]);
  }

  /// Elements cannot carry a crack that comes out of particles, nor one of whose sides there are only particles.
  void end_trails()
  {
    for (const PatchCracks& patch : patches_)
      for (const Trail& trail : patch.trails()) {
        bool stays = false;
        for (const track::Crossing& crossing : trail.found.crossings) {
          const Index number = patch.numbers()[crossing.cell];
          const std::optional<std::size_t> beside = patch.across(crossing);
          stays = stays || !chosen_.contains(number) || (beside && !chosen_.contains(patch.numbers()[*beside]));
          if (!stays) continue;
          chosen_.erase(number);
          if (beside) chosen_.erase(patch.numbers()[*beside]);
        }
      }
  }

  /// How far the elements to come carry a crack: up to the first cell that stays.
  crack::Polyline in_elements(const PatchCracks& patch, const Trail& trail) const
  {
    crack::Polyline handed;
    for (const track::Crossing& crossing : trail.found.crossings) {
      if (!chosen_.contains(patch.numbers()[crossing.cell])) break;
      handed.push_back(crossing.out);
    }
    return handed;
  }

  const SceneView& scene_;
  PatchMap map_;
  std::vector<PatchCracks> patches_;
  crack::CrackSet known_;                // all cracks as far as they part what they run through
  std::vector<crack::Polyline> lines_;   // their points
  std::vector<crack::Polyline> to_tips_; // and straight on from there to their tips
  std::span<const Retreat> reaches_;     // one per patch
  std::set<Index> far_, chosen_;         // natural numbers of cells far from all tips, and of those to be handed back
};
} // namespace

LayoutChange contraction(const SceneView& scene, std::span<const Retreat> reaches, const MayHandBack& may)
{
  if (!scene.sets) return {};
  Contraction contraction(scene, reaches);
  contraction.ask(may);
  return contraction.change();
}
} // namespace pdx::adapt
