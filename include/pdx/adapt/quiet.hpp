#pragma once
#include "pdx/adapt/conversion.hpp"

#include <unordered_map>

namespace pdx::adapt {
/// When particles become bulk again: all of a cell have all their bonds, and the cell has borne less than half of what
/// makes bulk ask, at so many looks in a row; and so have the cells that a margin reaches.
struct QuietRule {
  ConversionRule limits; ///< half of those are borne at most; its margin
  int looks = 8;
  law::Elastic elastic; ///< of particles
};

/// Cells of particles, and for how long each has been quiet.
class QuietCells {
public:
  /// Looks at all cells of patches, and returns those to be handed back, in the order of natural numbers, alike on
  /// every rank [m]. Collective.
  /// @param stay cells with their middle in one of them are never handed back [m]
  /// @param local displacement [owned | halo] [m]
  std::vector<geom::Box<2>> look(const SceneView& scene, const QuietRule& rule, std::span<const geom::Box<2>> stay,
                                 std::span<const double> local);

  /// Quiet looks in a row, by natural number of the cell; those of other ranks do no harm.
  const std::unordered_map<Index, int>& entries() const { return quiet_; }
  void take(Index cell, int looks) { quiet_[cell] = looks; }
  /// Cells may be other ranks' from now on: all know of all. Collective.
  void share(MPI_Comm comm);

private:
  std::unordered_map<Index, int> quiet_;
};

/// Per owned cell: is it particles, or may it become so? Collective.
std::vector<bool> may_be_particles(const SceneView& scene);
} // namespace pdx::adapt
