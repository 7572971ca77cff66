#pragma once
#include "pdx/field/rows.hpp"

namespace pdx::pd {
/// Finds the row of any lattice site from any rank: a table over site numbers, spread evenly over the ranks. Memory per
/// rank is the lattice over the number of ranks.
class SiteDirectory {
public:
  /// @param sites site numbers this rank owns; their rows follow each other from `first_row` (global). Collective.
  SiteDirectory(MPI_Comm comm, Index total_sites, std::span<const Index> sites, PetscInt first_row);
  /// Global row of each site asked for, -1 where no rank owns it. Collective.
  std::vector<PetscInt> rows(std::span<const Index> sites) const;

private:
  MPI_Comm comm_;
  Index total_;
  std::vector<PetscInt> table_; ///< rows of the sites this rank keeps the table for
};
} // namespace pdx::pd
