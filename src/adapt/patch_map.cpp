#include "pdx/adapt/patch_map.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <tuple>

namespace pdx::adapt {
namespace {
struct CellRecord {
  Index number, patch;
  std::array<double, 4> box; // lower and upper corner [m]
};

struct DamageRecord {
  Index patch;
  std::array<Index, 2> site;
  std::array<std::uint64_t, 2> gone;
  double damage;
  std::array<double, 2> x; // [m]
};

std::vector<CellRecord> covered_here(const mesh::Mesh& mesh)
{
  std::vector<CellRecord> mine;
  for (const Index c : mesh.cells(mesh::Use::covered)) {
    if (c >= mesh.owned_cells()) continue;
    const geom::Box<2> box = box_of(mesh, c);
    mine.push_back({mesh.natural_cell(c), mesh.patch(c), {box.lower[0], box.lower[1], box.upper[0], box.upper[1]}});
  }
  return mine;
}

std::vector<DamageRecord> damaged_here(const SceneView& scene)
{
  const couple::ParticleDamage all = couple::particle_damage(scene.halo.rows(), scene.bonds, scene.carried);
  const Index first = scene.halo.rows().first_particle();
  std::vector<DamageRecord> mine;
  for (std::size_t p = 0; p < scene.bonds.parts().size(); ++p) {
    const pd::LatticePart<2>& part = *scene.bonds.parts()[p];
    for (Index k = 0; k < static_cast<Index>(part.sites().size()); ++k) {
      const auto particle = static_cast<std::size_t>(part.first_row() - first + k);
      const auto gone = part.gone_of(k);
      if (gone[0] == 0 && gone[1] == 0 && all.damage[particle] + all.precrack[particle] <= kBroken) continue;
      const Site<2> site = part.site(part.sites()[static_cast<std::size_t>(k)]);
      const Vector<2>& x = scene.particles[particle].x;
      mine.push_back({static_cast<Index>(p), {site[0], site[1]}, gone, all.damage[particle], {x[0], x[1]}});
    }
  }
  return mine;
}
} // namespace

PatchMap map_patches(const SceneView& scene)
{
  PatchMap map;
  for (const auto& [number, patch, box] : gather_all(scene.mesh.comm(), covered_here(scene.mesh)))
    map.cells.push_back({number, patch, {{box[0], box[1]}, {box[2], box[3]}}});
  for (const auto& [patch, site, gone, damage, x] : gather_all(scene.mesh.comm(), damaged_here(scene)))
    map.damaged.push_back({patch, {site[0], site[1]}, gone, damage, {x[0], x[1]}});
  std::ranges::sort(map.cells, {}, &PatchMap::Cell::number);
  std::ranges::sort(map.damaged, [](const PatchMap::Damaged& a, const PatchMap::Damaged& b) {
    return std::tie(a.patch, a.site[1], a.site[0]) < std::tie(b.patch, b.site[1], b.site[0]);
  });
  return map;
}
} // namespace pdx::adapt
