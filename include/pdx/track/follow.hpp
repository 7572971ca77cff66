#pragma once
#include "pdx/track/bond_graph.hpp"
#include "pdx/track/tracker.hpp"

#include <optional>
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
      crossings;                 ///< in order, from the start on; only elements whose particles the crack parts wholly
  Vector<2> tip;                 ///< where the broken share of the weight of crossing bonds falls below one half [m]
  Vector<2> direction;           ///< unit vector of the path at its end
  std::vector<Vector<2>> beyond; ///< from behind the last crossing to the tip, a spacing apart [m]
};

/// Follows a crack from a point on through cells of particles (axis-aligned boxes made of whole lattice cells, given in
/// any order; neighbours share sides).
///
/// The particles of a cell and of one horizon around it must be in two bodies that are more than crumbs, one on either
/// side of the path in the cell, to a spacing. The line with the best margin between them is the crack in the cell. The
/// path comes in where it left the cell before, and leaves where the line does. A path within 1e-3 of a cell's edge of
/// a corner is on the corner, and so is one that passes up to half a spacing beside it on a side where the next cell's
/// line does not pass: it enters no cell for a sliver. One that runs along a line of the mesh is on the line, and in
/// the cells on its right. Crossings end before the first cell that is not parted so, and where the path would come
/// back to a cell; from there broken short bonds are followed to the tip. Time goes with the cells followed.
/// @param from where what is known of the crack ends, in or at the border of a cell; the first crossing begins there,
/// or on the line of the mesh or corner that it is within 1e-3 of an edge of
/// @param direction unit vector, straight on; the crack may turn here, by up to a right angle
Followed follow(const BondGraph& graph, std::span<const geom::Box<2>> cells, const Vector<2>& from,
                const Vector<2>& direction, Tracker tracker = Tracker::sides);

/// A crack of which no end is known.
struct FoundCrack {
  Followed ahead;       ///< from where it comes out of what is not parted
  Vector<2> tip_behind; ///< its other tip [m]
};
/// The crack that parts a cell, both ways from there; nothing if none does. Its sense is that of x, or of y if it runs
/// nearly across. A crack that branches off another begins so, behind the fork.
std::optional<FoundCrack> follow_both_ways(const BondGraph& graph, std::span<const geom::Box<2>> cells,
                                           std::size_t cell, Tracker tracker = Tracker::sides);
} // namespace pdx::track
