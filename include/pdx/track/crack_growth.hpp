#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/pd/lattice_part.hpp"

namespace pdx::track {
/// How far the crack has grown from a tip inside a patch, straight on: distances from the tip, along its direction, to
/// where bonds cross its prolongation. In a straight grown crack the two are a few spacings apart.
struct TipGrowth {
  std::size_t tip = 0;          ///< number in CrackSet::tips()
  std::size_t patch = 0;        ///< number of the patch it is in
  double first_intact = 0.0;    ///< nearest crossing of an intact bond; infinity if there is none [m]
  double farthest_broken = 0.0; ///< farthest crossing of a broken bond that no crack has cut; 0 if there is none [m]
};

/// Growth from each tip inside a patch; bonds of that patch only, and not beyond another crack (half way to a tip that
/// faces it). Bonds that seams of the mesh cut are not broken ones. A particle on the prolongation counts as left of
/// it. Collective; `parts` are those of a pd::BondTerm, in the same order on every rank.
std::vector<TipGrowth> crack_growth(MPI_Comm comm, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                                    const crack::CrackSet& cracks, const crack::CrackSet* seams = nullptr);
} // namespace pdx::track
