#pragma once
#include "lattice_units.hpp"

namespace pdx::track {
/// Where a crack ends beyond a point, in spacings: along a line fitted, from spacing to spacing, between the ends of
/// broken short bonds, to where the broken share of the weight of bonds crossing it falls below one half for good. Lone
/// intact bonds before and lone broken ones behind make no difference.
/// @return the tip, and the direction of the last horizon; `start` itself if no more is broken than intact from there
Line tip_ahead(const BondGraph& graph, const Line& start);
} // namespace pdx::track
