#pragma once
#include "pdx/geom/polygon.hpp"
#include "pdx/xfem/enrichment.hpp"

namespace pdx::xfem {
/// What a crack does to a cell that it cuts, alone or with others.
struct PieceCut {
  Index cell;
  int crack;
  CornerDistances distance;          ///< of the corners, as in `CellCut` [m]
  std::optional<Side> snapped;       ///< the whole cell lies on this side of the crack
  int entry = -1;                    ///< edge by which it comes into a cell that it ends in; -1: it runs through
  int other = -1;                    ///< the crack that it ends on
  Vector<2> end = Vector<2>::Zero(); ///< where [m]
};

/// Part of a cell's border.
struct EdgeShare {
  int edge;          ///< from corner `edge` to the next
  double begin, end; ///< fractions of it
};

/// A part of a cell that moves with one bilinear field.
struct Piece {
  std::vector<geom::Polygon> outlines; ///< convex; behind the first one slivers that move with it [m]
  std::vector<EdgeShare> edges;        ///< of the cell, as far as they move with it
  /// Which copy of its node each corner value is: -1 the node's own displacement, else the `code` of a set.
  std::array<int, 4> set{-1, -1, -1, -1};
  std::optional<Side> side; ///< of the crack, where only one cuts the cell
};

struct PiecedCell {
  Index cell = 0;
  std::vector<Piece> pieces;
};

/// A further copy of a node, for a body of its support that does not hold the node.
struct NodeCopy {
  /// The crack, where the body lies across that one crack only and is the only such one; a number from `cracks` on
  /// else.
  int code = 0;
  Side side = Side::minus; ///< of the node, as far as the set is that of a crack: H(x_i)
  Vector<2> at;            ///< a place in the body, near to the node [m]
};

struct CopiedNode {
  Index node = 0;
  std::vector<NodeCopy> copies; ///< by code
  int lost = 0;                 ///< bodies with too little of the support, which move with what is beside them
};

struct Pieces {
  std::vector<PiecedCell> cells; ///< ascending
  std::vector<CopiedNode> nodes; ///< of the cells that several cracks cut, ascending
};

/// Node copies where cracks meet: a node whose support cracks cut into bodies has a copy of its displacement for each
/// of them. Spans what Heaviside sets with junction functions span [XPD2 Eqs. 1-3], for any number of cracks in a cell
/// and along an edge. Inside a cell cracks are straight, from edge to edge or to the crack they end on. Bodies are
/// found by what touches along edges; those with less than `least_share` of a node's support move with their neighbour
/// in the same cell, so that no unknown is left without stiffness.
///
/// @param view its active cells are all around nodes of cells that more than one crack cuts, these included
/// @param cuts of those cells, ascending by cell
/// @param cracks how many there are
/// Nodes outside such cells keep the sets of `enrich`, whose code is their crack's.
Pieces cut_in_pieces(const MeshView& view, std::span<const PieceCut> cuts, double least_share, int cracks);

/// A piece as an element: all its points are on the plus side, `factor` is of the set, 0 for none.
/// @param enriched which corner values are copies
EnrichedElement piece_element(const fem::Corners& corners, const Piece& piece, const std::array<double, 4>& factor);
} // namespace pdx::xfem
