#pragma once
#include "pdx/track/bond_graph.hpp"

#include <span>

namespace pdx::track {
/// Blocks of particles that hold all places that bonds lost, for a crack to be followed through where no mesh says
/// other cells: a horizon and a spacing wide, cut into smaller ones at the border of the particles.
/// @param damaged sites that lost bonds, as the graph knows them
std::vector<geom::Box<2>> crack_blocks(const BondGraph& graph, std::span<const Site<2>> damaged);
} // namespace pdx::track
