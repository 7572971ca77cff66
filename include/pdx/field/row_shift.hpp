#pragma once
#include "pdx/field/rows.hpp"

#include <memory>
#include <span>
#include <vector>

namespace pdx::field {
/// Where the rows of one layout are in the next one on the same ranks, by runs that stay as they are: what is handed
/// from layout to layout is renumbered by it, without names.
class RowShift {
public:
  /// Global rows that follow each other in both layouts.
  struct Run {
    PetscInt from, to, length;
  };
  /// @param before halo of the layout that goes   @param mine runs of this rank, ascending. Collective.
  RowShift(std::unique_ptr<RowHalo> before, std::span<const Run> mine);

  /// Global row of the next layout, -1 for a row that goes.
  PetscInt operator()(PetscInt row) const;
  const RowHalo& before() const { return *before_; }
  /// The same of local rows of the layout before, [owned | halo]: only those rows of the halo that are asked for.
  /// @param now holds these   @param halo local rows of the layout before that other ranks own
  std::vector<Index> local_rows(const RowHalo& now, std::span<const Index> halo) const;

private:
  std::unique_ptr<RowHalo> before_;
  std::vector<Run> runs_; // of all ranks, ascending
};
} // namespace pdx::field
