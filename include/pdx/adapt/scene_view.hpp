#pragma once
#include "pdx/adapt/divided.hpp"
#include "pdx/couple/fracture.hpp"
#include "pdx/couple/surroundings.hpp"
#include "pdx/geom/box_cover.hpp"
#include "pdx/geom/same_lattice.hpp"
#include "pdx/pd/particles.hpp"

#include <algorithm>

namespace pdx::adapt {
inline constexpr double kGrown = 0.35;  ///< damage of particles beside a crack that has come by [-]
inline constexpr double kBroken = 1e-9; ///< of damage: less is rounding [-]

inline geom::LatticeAnchor anchor_of(const geom::Lattice<2>& lattice) { return {lattice.origin, lattice.dx}; }

/// The box around a cell.
inline geom::Box<2> box_of(const mesh::Mesh& mesh, Index cell) { return box_around(mesh.corners(cell)); }

/// What of a scene is looked at to move its patches; lent for one call.
struct SceneView {
  const mesh::Mesh& mesh;
  std::span<const PetscInt> node_rows;          ///< global row of each local vertex, -1 under a patch
  const xfem::EnrichedSets* sets;               ///< numbered; null without cracks
  std::span<const couple::Surroundings> around; ///< one per patch
  const pd::BondTerm<2>& bonds;
  const couple::CarriedBonds<2>* carried; ///< null without an interface
  const field::RowHalo& halo;
  std::span<const pd::Particle> particles; ///< owned, in order of rows
  std::span<const std::uint8_t> held;      ///< per owned component: does a condition hold it, but not what is around?
  std::span<const std::uint8_t> stays;     ///< per local cell: can it not become particles? Empty: all can
};

/// Calls visit(k) for owned particles in order: all of those of patches that touch one of the boxes.
template <class Visit>
void for_each_particle_near(const SceneView& scene, std::span<const geom::Box<2>> boxes, Visit&& visit)
{
  for (std::size_t p = 0; p < scene.around.size(); ++p) {
    const couple::PatchShape& shape = scene.around[p].shape();
    if (std::ranges::none_of(boxes, [&](const auto& box) { return geom::touch(box, shape.box, shape.lattice.dx); }))
      continue;
    const auto of = std::ranges::equal_range(scene.particles, static_cast<Index>(p), {}, &pd::Particle::patch);
    const auto first = static_cast<std::size_t>(of.begin() - scene.particles.begin());
    for (std::size_t k = first; k < first + of.size(); ++k) visit(k);
  }
}
} // namespace pdx::adapt
