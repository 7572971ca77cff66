#pragma once
#include "pdx/crack/crack_set.hpp"

#include <array>

namespace pdx::crack {
/// What a crack does to a cell. through: it enters and leaves. tip: it enters and ends, or is all inside.
enum class CellKind : std::uint8_t { whole, through, tip };

/// Four-node cells, convex, corners counter-clockwise.
struct CellView {
  std::span<const Vector<2>> points;           ///< [m]
  std::span<const std::array<Index, 4>> cells; ///< their points
};

/// A cell that a crack touches.
struct CutCell {
  Index cell = 0;
  CellKind kind = CellKind::whole;
  std::uint8_t edges = 0; ///< bit k: the crack crosses the edge from corner k to corner k + 1
};

/// Where one crack cuts a mesh. Sorted, the same for a cell whatever other cells are in the view.
struct Cuts {
  std::vector<double> distance; ///< per point, signed; |distance| >= tolerance                    [m]
  std::vector<CutCell> cells;   ///< cut through or with a tip; all others are whole
  std::vector<Index> points;    ///< corners of cells cut through: their support is cut
  std::vector<Index> closing;   ///< ends of the edges through which the crack runs into a cell that holds its tip:
                                ///< a crack that cannot be open inside a cell closes there
};

/// Finds what crack number `crack` cuts.
/// A crack that passes a point within the tolerance is seen as shifted to its right there, so that the point is on its
/// left, at the tolerance. Along an edge of the mesh it so cuts the cells to its right, in a strip as thin as the
/// tolerance. A tip within the tolerance before an edge reaches it: the cell behind is cut through, and the next holds
/// the tip. Edges are crossed once or not at all: of a crack that pokes out of a cell and comes back through the same
/// edge, the excursion is not seen.
/// @param tolerance > 0, far below the size of a cell [m]
Cuts find_cuts(const CrackSet& cracks, int crack, const CellView& mesh, double tolerance);
} // namespace pdx::crack
