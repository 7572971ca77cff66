#include "pdx/adapt/expansion.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::adapt {
namespace {
constexpr double kFits = 1e-6; // of a spacing, for sides of elements on lines of the lattice
constexpr double kSame = 1e-9; // of a distance: what is as far to rounding is judged alike

/// Damage next to the interface.
struct Front {
  Index patch;
  std::array<double, 2> x; // [m]
};

std::vector<Front> fronts(const SceneView& scene, std::span<const Reaches> reaches)
{
  const couple::ParticleDamage all = couple::particle_damage(scene.halo.rows(), scene.bonds, scene.carried);
  std::vector<Front> mine;
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const pd::Particle& p = scene.particles[k];
    const auto patch = static_cast<std::size_t>(p.patch);
    if (all.damage[k] > kBroken && scene.around[patch].distance(p.x) < (1.0 - kSame) * reaches[patch].critical)
      mine.push_back({p.patch, {p.x[0], p.x[1]}});
  }
  return gather_all(scene.mesh.comm(), mine);
}

/// Does a cell have the sides of whole cells of a lattice?
bool is_divided(const std::array<Vector<2>, 4>& corners, const geom::Box<2>& box, const geom::Lattice<2>& lattice)
{
  for (const Vector<2>& x : corners)
    for (Eigen::Index d = 0; d < 2; ++d) {
      const double line = (x[d] - lattice.origin[d]) / lattice.dx;
      const bool on_box = std::min(std::abs(x[d] - box.lower[d]), std::abs(x[d] - box.upper[d])) < kFits * lattice.dx;
      if (!on_box || std::abs(line - std::round(line)) > kFits * std::max(1.0, std::abs(line))) return false;
    }
  return true;
}

geom::Box<2> box_around(const std::array<Vector<2>, 4>& corners)
{
  geom::Box<2> box{corners[0], corners[0]};
  for (const Vector<2>& x : corners) box = {box.lower.cwiseMin(x), box.upper.cwiseMax(x)};
  return box;
}

struct Found {
  Index cell;                ///< natural number
  std::array<double, 4> box; ///< lower and upper corner [m]
  double spacing;            ///< [m]
};

Found found(const mesh::Mesh& mesh, Index cell, const geom::Box<2>& box, double spacing)
{
  return {mesh.natural_cell(cell), {box.lower[0], box.lower[1], box.upper[0], box.upper[1]}, spacing};
}

/// Those of all ranks, by natural number.
std::vector<LayoutChange::Cover> gathered(MPI_Comm comm, std::vector<Found> mine)
{
  std::vector<Found> all = gather_all(comm, mine);
  std::ranges::sort(all, {}, &Found::cell);
  std::vector<LayoutChange::Cover> covers;
  for (const auto& [cell, box, spacing] : all) covers.push_back({{{box[0], box[1]}, {box[2], box[3]}}, spacing});
  return covers;
}
} // namespace

namespace {
/// Does no crack run through a cell?
bool is_whole(const SceneView& scene, Index cell)
{
  if (!scene.sets) return true;
  const auto x = scene.mesh.corners(cell);
  const crack::CrackSet& cracks = scene.sets->cracks();
  return !cracks.cuts(x[0], x[2]) && !cracks.cuts(x[1], x[3]);
}
} // namespace

std::vector<LayoutChange::Cover> expansion(const SceneView& scene, std::span<const Reaches> reaches)
{
  const std::vector<Front> damage = fronts(scene, reaches);
  if (damage.empty()) return {};
  const mesh::Mesh& mesh = scene.mesh;
  std::vector<Found> mine;
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    if (mesh.use(c) == mesh::Use::covered) continue;
    const auto corners = mesh.corners(c);
    const geom::Box<2> box = box_around(corners);
    for (const Front& front : damage) {
      const auto patch = static_cast<std::size_t>(front.patch);
      const double far = (1.0 - kSame) * reaches[patch].expansion;
      const Vector<2> at(front.x[0], front.x[1]);
      if (!box.contains(at, far)) continue;
      if (std::ranges::none_of(corners, [&](const Vector<2>& x) { return (x - at).norm() < far; })) continue;
      const geom::Lattice<2>& lattice = scene.around[patch].shape().lattice;
      if (is_divided(corners, box, lattice)) mine.push_back(found(mesh, c, box, lattice.dx));
      break;
    }
  }
  return gathered(mesh.comm(), std::move(mine));
}

LayoutChange exchanged(const SceneView& scene, const geom::Box<2>& box)
{
  const mesh::Mesh& mesh = scene.mesh;
  const geom::Lattice<2>& lattice = scene.around.front().shape().lattice;
  std::vector<Found> elements, covered;
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    if (!box.contains(mesh.centroid(c))) continue;
    const geom::Box<2> cell = box_around(mesh.corners(c));
    if (mesh.use(c) == mesh::Use::covered && is_whole(scene, c))
      covered.push_back(found(mesh, c, cell, lattice.dx));
    else if (mesh.use(c) != mesh::Use::covered && is_divided(mesh.corners(c), cell, lattice))
      elements.push_back(found(mesh, c, cell, lattice.dx));
  }
  LayoutChange change;
  for (const auto& [where, spacing] : gathered(mesh.comm(), std::move(covered))) change.uncover.push_back(where);
  if (change.uncover.empty()) change.cover = gathered(mesh.comm(), std::move(elements));
  return change;
}
} // namespace pdx::adapt
