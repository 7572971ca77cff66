#pragma once
#include "pdx/track/bond_graph.hpp"

#include <span>

namespace pdx::track {
/// An element that a crack has come through: where it enters and leaves [m].
struct Crossing {
  std::size_t cell;
  Vector<2> in, out;
};

/// How far a crack has come.
struct Followed {
  std::vector<Crossing>
      crossings;       ///< in order, from the start on; only elements whose particles the crack parts wholly
  Vector<2> tip;       ///< where the broken share of the weight of crossing bonds falls below one half [m]
  Vector<2> direction; ///< unit vector of the path at its end
};

/// Follows a crack from a point on through cells of particles (axis-aligned boxes made of whole lattice cells, given in
/// any order; neighbours share sides).
///
/// The particles of a cell and of one horizon around it must be in two bodies, one on either side; a line fitted
/// between them is the crack in the cell. It comes in where it left the cell before, and leaves where the line does.
/// What is within 1e-3 of a cell's edge of a corner is on the corner, and likewise on a line of the mesh along which it
/// runs; a crack along a side is in the cell on its right. At the first other cell the crossings end; from there damage
/// is followed to the tip. A cell is crossed once at most, and not if the crack turns back in it.
/// @param from where what is known of the crack ends, in or at the border of a cell; the first crossing begins there,
/// or at the corner or mesh line that it is next to
/// @param direction unit vector, straight on
Followed follow(const BondGraph& graph, std::span<const geom::Box<2>> cells, const Vector<2>& from,
                const Vector<2>& direction);
} // namespace pdx::track
