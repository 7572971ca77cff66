#include "pdx/adapt/expansion.hpp"

#include "cover_list.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::adapt {
namespace {

/// New damage next to the interface.
struct Front {
  Index patch;
  std::array<double, 2> x; // [m]
};

/// Where elements hand their cracks over to particles: what breaks around there belongs to what the crack leaves
/// behind.
std::vector<Vector<2>> mouths(const SceneView& scene)
{
  std::vector<Vector<2>> found;
  if (!scene.sets) return found;
  for (const crack::Tip& tip : scene.sets->cracks().tips())
    if (std::ranges::any_of(scene.around, [&tip](const couple::Surroundings& around) {
          return around.distance(tip.at) < kFits * around.shape().lattice.dx;
        }))
      found.push_back(tip.at);
  return found;
}

std::vector<Front> fronts(const SceneView& scene, std::span<const Reaches> reaches, std::span<const Index> news)
{
  const std::vector<Vector<2>> behind = news.empty() ? std::vector<Vector<2>>() : mouths(scene);
  std::vector<Front> mine;
  for (const Index k : news) {
    const pd::Particle& p = scene.particles[static_cast<std::size_t>(k)];
    const auto patch = static_cast<std::size_t>(p.patch);
    const double critical = (1.0 - kSame) * reaches[patch].critical;
    const double wake = critical + scene.bonds.parts()[patch]->stencil().horizon;
    if (std::ranges::any_of(behind, [&](const Vector<2>& mouth) { return (mouth - p.x).norm() < wake; })) continue;
    if (scene.around[patch].distance(p.x) < critical) mine.push_back({p.patch, {p.x[0], p.x[1]}});
  }
  return gather_all(scene.mesh.comm(), mine);
}

/// Does no crack run through a cell?
bool is_whole(const SceneView& scene, Index cell)
{
  if (!scene.sets) return true;
  const auto x = scene.mesh.corners(cell);
  const crack::CrackSet& cracks = scene.sets->cracks();
  return !cracks.cuts(x[0], x[2]) && !cracks.cuts(x[1], x[3]);
}

} // namespace

std::optional<Vector<2>> broken_at_border(const SceneView& scene, std::span<const Reaches> reaches)
{
  std::vector<Index> broken;
  for (const auto& [k, damage] : couple::damaged_particles(scene.halo.rows(), scene.bonds, scene.carried))
    if (damage > kGrown) broken.push_back(k);
  const std::vector<Front> near = fronts(scene, reaches, broken);
  if (near.empty()) return std::nullopt;
  const auto& x = std::ranges::min(near, {}, &Front::x).x;
  return Vector<2>(x[0], x[1]);
}

bool can_expand(const SceneView& scene)
{
  bool any = false, left = false;
  for (Index c = 0; c < scene.mesh.owned_cells(); ++c) {
    left = left || scene.mesh.use(c) != mesh::Use::covered;
    for (const couple::Surroundings& around : scene.around)
      any = any || (can_cover(scene, c) && is_divided(scene.mesh.corners(c), around.shape().lattice));
  }
  return any_rank(scene.mesh.comm(), any) || !any_rank(scene.mesh.comm(), left);
}

std::vector<LayoutChange::Cover> expansion(const SceneView& scene, std::span<const Reaches> reaches,
                                           std::span<const Index> news, bool spare_held)
{
  const std::vector<Front> damage = fronts(scene, reaches, news);
  if (damage.empty()) return {};
  const mesh::Mesh& mesh = scene.mesh;
  const HeldCells held(scene, spare_held);
  std::vector<Found> mine;
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    if (!can_cover(scene, c) || held.has(c)) continue;
    const auto corners = mesh.corners(c);
    const geom::Box<2> box = box_of(mesh, c);
    std::size_t first = scene.around.size(); // patch that wants it and can have it
    for (const Front& front : damage) {
      const auto patch = static_cast<std::size_t>(front.patch);
      const double far = (1.0 - kSame) * reaches[patch].expansion;
      const Vector<2> at(front.x[0], front.x[1]);
      if (patch >= first || !box.contains(at, far)) continue;
      if (scene.around[patch].shape().body != mesh.body(c)) continue;
      if (std::ranges::none_of(corners, [&](const Vector<2>& x) { return (x - at).norm() < far; })) continue;
      const geom::Lattice<2>& lattice = scene.around[patch].shape().lattice;
      if (is_divided(corners, lattice) && !meets_another(scene, mesh.body(c), box, anchor_of(lattice))) first = patch;
    }
    if (first < scene.around.size()) mine.push_back(found(mesh, c, box, scene.around[first].shape().lattice.dx));
  }
  return apart(gathered(mesh.comm(), mine));
}

LayoutChange exchanged(const SceneView& scene, const geom::Box<2>& box, bool spare_held)
{
  const mesh::Mesh& mesh = scene.mesh;
  const geom::Lattice<2>& lattice = scene.around.front().shape().lattice;
  const HeldCells held(scene, spare_held);
  std::vector<Found> elements, covered;
  std::int64_t left = 0; // covered cells outside the box
  for (const Index c : mesh.cells(mesh::Use::covered))
    left += c < mesh.owned_cells() && !box.contains(mesh.centroid(c));
  MPI_Allreduce(MPI_IN_PLACE, &left, 1, MPI_INT64_T, MPI_SUM, mesh.comm());
  if (left == 0) return {}; // some patch must stay
  for (const Index c : mesh.finder().in(box)) {
    if (c >= mesh.owned_cells() || held.has(c)) continue;
    const geom::Box<2> cell = box_of(mesh, c);
    if (mesh.use(c) == mesh::Use::covered && is_whole(scene, c))
      covered.push_back(found(mesh, c, cell, lattice.dx));
    else if (can_cover(scene, c) && is_divided(mesh.corners(c), lattice) &&
             !meets_another(scene, mesh.body(c), cell, anchor_of(lattice)))
      elements.push_back(found(mesh, c, cell, lattice.dx));
  }
  LayoutChange change;
  for (const LayoutChange::Cover& cell : gathered(mesh.comm(), covered)) change.uncover.push_back(cell.box);
  if (change.uncover.empty()) change.cover = gathered(mesh.comm(), elements);
  return change;
}
} // namespace pdx::adapt
