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
  /// The same sites have other rows from now on, which follow each other from this one. Collective.
  void move(PetscInt first_row);
  /// Where a row is now that was given at first.
  PetscInt moved(PetscInt row) const;

private:
  /// Rows of a rank: those given at first, how many, and where they are now.
  struct Span {
    PetscInt given, count, now;
  };
  MPI_Comm comm_;
  Index total_;
  PetscInt first_, count_;      ///< rows given
  std::vector<PetscInt> table_; ///< rows, as given, of the sites this rank keeps the table for
  std::vector<Span> spans_;     ///< by rank; empty: rows are where they were given
};
} // namespace pdx::pd
