#pragma once
#include "lattice_units.hpp"

namespace pdx::track {
/// Where a crack ends beyond a point, in spacings: along a line fitted, from spacing to spacing, between the ends of
/// broken short bonds, to where the broken share of the weight of bonds crossing it falls below one half for good. Lone
/// intact bonds before and lone broken ones behind make no difference.
struct Ahead {
  Line tip; ///< with the direction of the last horizon; the start if no more is broken than intact
  std::vector<Vector<2>>
      way;      ///< from the start to the tip, a spacing between neighbours; the start alone if it is that
  double share; ///< broken, of what crosses the first horizon of it; 0 if the start is the tip
};
Ahead tip_ahead(const BondGraph& graph, const Line& start);
} // namespace pdx::track
