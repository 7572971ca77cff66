#include "pdx/adapt/contraction.hpp"

#include "patch_cracks.hpp"
#include "pdx/base/gather.hpp"

namespace pdx::adapt {
namespace {
/// All patches, and the cracks of the scene as far as they are known.
class Contraction {
public:
  Contraction(const SceneView& scene, std::span<const Retreat> reaches)
      : scene_(scene), map_(map_patches(scene)), reaches_(reaches)
  {
    for (std::size_t p = 0; p < scene.around.size(); ++p) patches_.emplace_back(scene, map_, p, reaches[p].tracker);
    lines_ = given();
    std::set<Index> taken; // natural numbers of cells
    for (PatchCracks& patch : patches_)
      for (Trail& trail : patch.trails()) {
        patch.keep_what_is_free(trail, 0, taken);
        if (!extend(lines_, trail, trail.corners())) trail.found.crossings.clear();
      }
    to_tips_ = lines_;
    for (const PatchCracks& patch : patches_)
      for (const Trail& trail : patch.trails()) extend(to_tips_, trail, {trail.found.tip});
    for (std::size_t p = 0; p < patches_.size(); ++p)
      while (auto trail = patches_[p].unknown(to_tips_, reaches[p].contraction, taken))
        take(patches_[p], std::move(*trail));
    known_ = crack::CrackSet(lines_, scene.mesh.bounds());
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
        if (!trail.other_tip)
          go_on(cracks, trail, handed);
        else if (!handed.empty())
          cracks.push_back(gone_on({handed[0], handed[1]}, true, std::span(handed).subspan(2)));
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
    crack::Polyline& crack = cracks[trail.crack];
    crack = gone_on(std::move(crack), trail.last, ahead);
  }

  /// Goes on with a crack, unless it would come to run along another or cross itself. Does it?
  bool extend(std::vector<crack::Polyline>& cracks, const Trail& trail, const crack::Polyline& ahead) const
  {
    std::vector<crack::Polyline> longer = cracks;
    go_on(longer, trail, ahead);
    if (!stand(longer)) return false;
    cracks = std::move(longer);
    return true;
  }

  /// Knows one more crack, unless its path makes none.
  void take(PatchCracks& patch, Trail trail)
  {
    const crack::Polyline corners = trail.corners();
    const Vector<2>& begin = trail.found.crossings.front().in;
    const crack::Polyline line = gone_on({begin, corners.front()}, true, corners);
    crack::Polyline whole{begin};
    if ((begin - *trail.other_tip).dot(corners.front() - begin) > 0.0) whole.insert(whole.begin(), *trail.other_tip);
    whole = gone_on(gone_on(std::move(whole), true, corners), true, {{trail.found.tip}});
    if (!goes_with(lines_, line) || !goes_with(to_tips_, whole)) return;
    trail.crack = lines_.size();
    lines_.push_back(line);
    to_tips_.push_back(std::move(whole));
    patch.add(std::move(trail));
  }
  bool goes_with(std::vector<crack::Polyline> cracks, const crack::Polyline& more) const
  {
    cracks.push_back(more);
    return stand(std::move(cracks));
  }
  bool stand(std::vector<crack::Polyline> cracks) const
  {
    try {
      (void)crack::CrackSet(std::move(cracks), scene_.mesh.bounds());
      return true;
    } catch (const UserError&) { // it crosses itself, or runs along another
      return false;
    }
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
      if (!patch.has_way_ahead(cell) && patch.is_parted_by(known_, lines_, cell)) chosen_.insert(patch.numbers()[c]);
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
    for (std::size_t before = chosen_.size() + 1; chosen_.size() < before;) { // what ends one may end another
      before = chosen_.size();
      end_each_trail();
    }
  }
  void end_each_trail()
  {
    for (const PatchCracks& patch : patches_)
      for (const Trail& trail : patch.trails()) {
        const auto [first, end] = run_of(patch, trail);
        const std::vector<track::Crossing>& all = trail.found.crossings;
        for (std::size_t k = 0; k < all.size(); ++k) {
          if (k >= first && k < end) continue;
          chosen_.erase(patch.numbers()[all[k].cell]);
          if (const auto beside = patch.across(all[k])) chosen_.erase(patch.numbers()[*beside]);
        }
      }
  }

  /// The crossings that elements to come can carry: up to the first cell that stays; of a crack that they have nothing
  /// of yet the longest run between cells that stay, nothing of one that branches off another. No end is in a sliver.
  std::pair<std::size_t, std::size_t> run_of(const PatchCracks& patch, const Trail& trail) const
  {
    const std::vector<track::Crossing>& all = trail.found.crossings;
    if (patch.branches_off(trail)) return {0, 0};
    const auto stays = [&](const track::Crossing& crossing) {
      const std::optional<std::size_t> beside = patch.across(crossing);
      return !chosen_.contains(patch.numbers()[crossing.cell]) ||
             (beside && !chosen_.contains(patch.numbers()[*beside]));
    };
    std::pair<std::size_t, std::size_t> longest{0, 0};
    std::size_t first = 0;
    for (std::size_t k = 0; k <= all.size(); ++k) {
      if (k < all.size() && !stays(all[k])) continue;
      if (k - first > longest.second - longest.first) longest = {first, k};
      if (!trail.other_tip) break;
      first = k + 1;
    }
    auto& [begin, end] = longest;
    while (end > begin && patch.is_sliver(all[end - 1])) --end;
    if (!trail.other_tip) return longest;
    while (end > begin && patch.is_sliver(all[begin])) ++begin;
    if (end - begin < kLeastRun) return {0, 0};
    return longest;
  }

  /// The points of those crossings; of a crack that elements have nothing of yet with the first.
  crack::Polyline in_elements(const PatchCracks& patch, const Trail& trail) const
  {
    crack::Polyline handed;
    const auto [first, end] = run_of(patch, trail);
    if (trail.other_tip && end > first) handed.push_back(trail.found.crossings[first].in);
    for (std::size_t k = first; k < end; ++k) handed.push_back(trail.found.crossings[k].out);
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
