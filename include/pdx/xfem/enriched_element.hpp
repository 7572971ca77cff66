#pragma once
#include "pdx/xfem/cut.hpp"

#include <algorithm>
#include <optional>

namespace pdx::xfem {
/// A four-node element that one crack cuts, or one of the pieces that several leave of it. Its unknowns: x and y of
/// corners 1 to 4, then x and y of the enriched sets of its enriched corners, in corner order.
struct EnrichedElement {
  CutCell cell;                   ///< where it is integrated
  std::array<Side, 4> side{};     ///< of each corner: H(x_i)
  std::array<bool, 4> enriched{}; ///< has the corner an enriched set?
  /// Of a piece, which is all on the plus side of `cell`: what the set of each corner is multiplied by. `side` says
  /// nothing then.
  std::optional<std::array<double, 4>> of_piece;

  /// What the set of a corner is multiplied by on a side: 0 where the corner value is the node's own [XPD1 Eq. 12].
  double factor(std::size_t corner, Side at) const
  {
    return of_piece ? (*of_piece)[corner] : shifted_step(at, side[corner]);
  }

  int unknowns() const { return 8 + 2 * static_cast<int>(std::ranges::count(enriched, true)); } ///< 8 to 16
};

/// Displacements [m] or forces [N] of an element's unknowns.
using EnrichedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 16, 1>;
/// Tangent [N/m] in the same order.
using EnrichedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 16, 16>;
} // namespace pdx::xfem
