#pragma once
#include "pdx/pd/lattice_part.hpp"

#include <span>
#include <vector>

namespace pdx::couple {
/// Where bonds of a patch that start at this rank's particles end on others, whatever of them is broken.
class ForeignEnds {
public:
  /// Collective.
  explicit ForeignEnds(const pd::LatticePart<2>& part);

  std::span<const PetscInt> rows() const { return rows_; } ///< global, by ascending site
  PetscInt row(Index site) const;                          ///< global; of one of them

private:
  std::vector<Index> sites_; // ascending
  std::vector<PetscInt> rows_;
};
} // namespace pdx::couple
