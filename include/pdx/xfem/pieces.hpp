#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/polygon.hpp"
#include "pdx/xfem/enrichment.hpp"

namespace pdx::xfem {
/// A crack that runs through a cell, alone or with others.
struct PieceCut {
  Index cell;
  int crack;
  CornerDistances distance;    ///< of the corners, as in `CellCut` [m]
  std::optional<Side> snapped; ///< the whole cell lies on this side of the crack
};

/// A cell that a crack may reach.
struct NearCell {
  Index cell;
  int crack;
};

/// A cell that distances of its corners do not describe.
struct Meeting {
  Index cell;
  bool several; ///< several cracks part it; else one bends in it, or some meet on its border
};

/// The cells among those near to cracks that have to be seen as pieces: several cracks part them or meet on their
/// border, or one bends in them, or comes in and leaves by one edge.
/// @param near ascending by cell   @param cuts cracks that run through cells, ascending by cell
/// @param tolerance what is nearer is one place [m]
std::vector<Meeting> find_meetings(const MeshView& view, std::span<const NearCell> near, std::span<const CellCut> cuts,
                                   const crack::CrackSet& cracks, double tolerance);

/// Part of a cell's border.
struct EdgeShare {
  int edge;          ///< from corner `edge` to the next
  double begin, end; ///< fractions of it
};

/// A part of a cell that moves with one bilinear field.
struct Piece {
  std::vector<geom::Polygon> outlines; ///< convex; slivers that move with it behind its own [m]
  std::vector<EdgeShare> edges;        ///< of the cell, as far as they move with it
  /// Which copy of its node each corner value is: -1 the node's own displacement, else the `code` of a set.
  std::array<int, 4> set{-1, -1, -1, -1};
  std::optional<Side> side; ///< of the crack, where only one cuts the cell
};

struct PiecedCell {
  Index cell = 0;
  std::vector<Piece> pieces;

  /// The side that all of a cell that one crack cuts lies on, because slivers were given up. Where nodes of the cell
  /// have no copies, their sets have to learn it (`Snaps`): they may have too little left.
  std::optional<Side> left() const { return pieces.size() == 1 ? pieces[0].side : std::nullopt; }
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
  std::vector<CopiedNode> nodes; ///< that have copies, ascending
};

/// Nodes that one crack passes twice, so that what lies across it does not hang together in their support; ascending.
/// Right for those whose cells are all in the view.
/// @param cuts as above
std::vector<Index> nodes_passed_twice(const MeshView& view, std::span<const CellCut> cuts);

/// Node copies where cracks meet: a node whose support cracks cut into bodies has a copy of its displacement for each
/// of them. Spans what Heaviside sets with junction functions span [XPD2 Eqs. 1-3], for any number of cracks in a cell
/// and along an edge, wherever they bend and meet. Bodies are found by what touches along edges; those with less than
/// `least_share` of a node's support move with their neighbour in the same cell, so that no unknown is left without
/// stiffness. Other nodes keep the sets of `enrich`, whose code is their crack's.
/// @param view its active cells are all around the nodes; numbers of nodes rank as on every rank
/// @param cuts of those cells, ascending by cell   @param nodes that have copies, ascending
/// @param tolerance what is nearer is one place [m]
Pieces cut_in_pieces(const MeshView& view, std::span<const PieceCut> cuts, std::span<const Index> nodes,
                     const crack::CrackSet& cracks, double least_share, double tolerance);

/// A piece as an element: all its points are on the plus side, `factor` is of the set, 0 for none.
/// @param enriched which corner values are copies
EnrichedElement piece_element(const fem::Corners& corners, const Piece& piece, const std::array<double, 4>& factor);
} // namespace pdx::xfem
