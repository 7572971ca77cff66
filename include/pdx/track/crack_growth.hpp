#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/pd/lattice_part.hpp"

#include <optional>

namespace pdx::track {
/// How far a crack has grown from its end inside a patch, whichever way it turned. Places are distances from that end
/// along the path, and straight on behind it.
struct TipGrowth {
  std::size_t tip = 0;   ///< number in CrackSet::tips()
  std::size_t patch = 0; ///< number of the patch it is in
  crack::Polyline path;  ///< from the crack's end to where its tip is now; the end alone if nothing grew [m]
  Vector<2> direction = Vector<2>::UnitX(); ///< unit vector, straight on behind the path
  double first_intact = 0.0;                ///< nearest place of an intact bond; infinity if there is none [m]
  double farthest_broken = 0.0;   ///< farthest place of a broken bond that no crack has cut; 0 if there is none [m]
  std::optional<std::size_t> met; ///< number of a tip that the path came to: that of the other crack
};

/// Growth from each tip inside a patch, as the bonds of that patch tell: the line between the bodies that they hold
/// together, on to where half of what crosses it is broken (`follow`). Not beyond another crack, nor the path of one;
/// bonds that cross the way straight on not beyond half way to a tip that faces it. Bonds that seams of the mesh cut
/// are not broken ones. A particle on the path counts as left of it. Collective; `parts` are those of a pd::BondTerm,
/// in the same order on every rank, and so is what is returned.
std::vector<TipGrowth> crack_growth(MPI_Comm comm, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                                    const crack::CrackSet& cracks, const crack::CrackSet* seams = nullptr);

double length(const crack::Polyline& path); ///< [m]
/// The place at a distance along a path; behind its end straight on. [m]
Vector<2> place_on(const crack::Polyline& path, const Vector<2>& direction, double distance);
/// What of a path lies before a distance, with the place there. [m]
crack::Polyline path_up_to(const crack::Polyline& path, double distance);
} // namespace pdx::track
