#pragma once
#include "pdx/adapt/divided.hpp"
#include "pdx/couple/fracture.hpp"
#include "pdx/couple/surroundings.hpp"
#include "pdx/geom/same_lattice.hpp"
#include "pdx/pd/particles.hpp"

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
} // namespace pdx::adapt
