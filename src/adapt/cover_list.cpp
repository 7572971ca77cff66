#include "cover_list.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/geom/box_cover.hpp"
#include "pdx/mesh/vertex_halo.hpp"

#include <algorithm>

namespace pdx::adapt {
namespace covers {
bool meet(const geom::Box<2>& a, const geom::Box<2>& b) { return geom::touch(a, b, kFits * a.size().minCoeff()); }
} // namespace covers

Found found(const mesh::Mesh& mesh, Index cell, const geom::Box<2>& box, double spacing)
{
  return {mesh.natural_cell(cell), mesh.body(cell), {box.lower[0], box.lower[1], box.upper[0], box.upper[1]}, spacing};
}

std::vector<LayoutChange::Cover> gathered(MPI_Comm comm, const std::vector<Found>& mine)
{
  std::vector<Found> all = gather_all(comm, mine);
  std::ranges::sort(all, {}, &Found::cell);
  std::vector<LayoutChange::Cover> covers;
  for (const auto& [cell, body, box, spacing] : all)
    covers.push_back({{{box[0], box[1]}, {box[2], box[3]}}, spacing, body});
  return covers;
}

bool meets_another(const SceneView& scene, Index body, const geom::Box<2>& box, const geom::LatticeAnchor& lattice)
{
  return std::ranges::any_of(scene.around, [&](const couple::Surroundings& around) {
    const couple::PatchShape& shape = around.shape();
    return shape.body == body && !geom::same_lattice(anchor_of(shape.lattice), lattice) &&
           std::ranges::any_of(shape.boxes, [&](const geom::Box<2>& other) { return covers::meet(box, other); });
  });
}

std::vector<LayoutChange::Cover> apart(const std::vector<LayoutChange::Cover>& covers)
{
  std::vector<LayoutChange::Cover> kept;
  for (const LayoutChange::Cover& cover : covers) {
    const auto strange = [&](const LayoutChange::Cover& other) {
      return other.body == cover.body && !geom::same_lattice(cover.lattice(), other.lattice()) &&
             covers::meet(cover.box, other.box);
    };
    if (std::ranges::none_of(kept, strange)) kept.push_back(cover);
  }
  return kept;
}

HeldCells::HeldCells(const SceneView& scene, bool asked)
    : mesh_(scene.mesh), node_(asked ? static_cast<std::size_t>(scene.mesh.vertices()) : 0, 0)
{
  if (!asked) return;
  const field::Rows& rows = scene.halo.rows();
  for (Index v = 0; v < mesh_.owned_vertices(); ++v) {
    const PetscInt row = scene.node_rows[static_cast<std::size_t>(v)] - rows.first;
    if (row < 0 || row >= rows.nodes) continue;
    const auto at = 2 * static_cast<std::size_t>(row);
    node_[static_cast<std::size_t>(v)] = scene.held[at] || scene.held[at + 1];
  }
  mesh::fill_halo(mesh_, MPI_INT, 1, node_.data());
}

bool HeldCells::has(Index cell) const
{
  return !node_.empty() &&
         std::ranges::any_of(mesh_.cell(cell), [&](Index v) { return node_[static_cast<std::size_t>(v)] != 0; });
}

bool can_cover(const SceneView& scene, Index cell)
{
  return scene.mesh.use(cell) != mesh::Use::covered &&
         (scene.stays.empty() || !scene.stays[static_cast<std::size_t>(cell)]);
}
} // namespace pdx::adapt
