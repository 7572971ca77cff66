#pragma once
#include "pdx/couple/surroundings.hpp"

namespace pdx::couple {
/// The sides of cells near patches that no other cell shares, as cracks for bonds: where the mesh is parted (doubled
/// nodes, parts that only look joined, slits) particles are parted too, tips and mouths included. Elements need no
/// crack there, they have their own nodes. Pieces overlap, so that bonds through their joints are cut as well.
/// The same on every rank. Collective.
/// @param reach  how far outside a patch bonds act, in spacings; 0: only what lies inside counts, not its border
crack::CrackSet find_seams(const mesh::Mesh& mesh, std::span<const PatchShape> patches, double reach);
} // namespace pdx::couple
