#pragma once
#include "lattice_units.hpp"

namespace pdx::track {
/// Where a crack ends beyond a point, in spacings: along lines fitted to the middles of broken short bonds, step by
/// step, to where the broken share of the weight of bonds crossing them falls below one half for good.
/// @return the tip, and the direction there; `start` itself if no bond beyond it is broken
Line tip_ahead(const BondGraph& graph, const Line& start);
} // namespace pdx::track
