#pragma once
#include "pdx/field/row_name.hpp"

#include <span>
#include <vector>

namespace pdx::field {
/// Which of a rank's rows go on under another layout as they are: runs of them, local numbers of either layout. Nothing
/// of what stays needs a name; of what does not, the names are here.
struct StayingRows {
  struct Run {
    Index from, to, length;
  };
  Index before = 0, now = 0;  ///< owned rows of either layout
  std::vector<Run> runs;      ///< each row in one at most
  std::vector<RowName> names; ///< of `leaving`

  std::vector<Index> leaving() const; ///< rows before that are in no run, ascending
  std::vector<Index> coming() const;  ///< rows now that are in none, likewise
  /// The same counted from some row of either layout on, which no run passes.
  StayingRows behind(Index first_before, Index first_now) const;

  /// Values of the rows before become those of the rows now, 0 where they come; what stays where it was is not touched.
  /// @param values so many for each row
  void carry(std::vector<double>& values, int components) const;
};

/// Values of some rows.
std::vector<double> values_of(std::span<const Index> rows, std::span<const double> values, int components);
} // namespace pdx::field
