#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/mesh/mesh.hpp"
#include "pdx/xfem/pieces.hpp"

namespace pdx::xfem {
/// How far x is inside a cell; below 0 outside [m].
double depth_in(const mesh::Mesh& mesh, Index cell, const Vector<2>& x);

/// A crack that comes into a cell and ends there on another.
struct EndCut {
  std::size_t junction; ///< its number in the CrackSet
  PieceCut cut;
};

/// The cells around nodes of cells that several cracks cut, and what becomes of them. The same on every rank.
class JunctionZone {
public:
  /// Finds the nodes. Throws UserError for an end on another crack that no cell has both cracks of, and for nodes that
  /// are a patch's too. Collective.
  /// @param cuts cracks that run through local active cells, ascending by cell
  JunctionZone(const mesh::Mesh& mesh, const crack::CrackSet& cracks, std::span<const CellCut> cuts,
               std::span<const EndCut> ends, double tolerance, const geom::Frame& frame);
  bool empty() const { return nodes_.empty(); }
  /// Parts the cells, once it is known which are snapped. Collective.
  void part(std::span<const CellCut> cuts, const Snaps& snapped, double least_share);

  bool has_node(Index vertex) const; ///< local number; its sets are those of `copies`
  bool has_cell(Index cell) const { return place_of_cell_[static_cast<std::size_t>(cell)] >= 0; } ///< local number
  /// Pieces of a local cell that it has.
  const std::vector<Piece>& pieces(Index cell) const;
  const CopiedNode& copies(Index vertex) const; ///< of a local vertex that it has
  int codes() const { return codes_; }          ///< of sets are below this number

private:
  void refuse_ends(std::span<const CellCut> cuts, std::span<const EndCut> ends, double tolerance,
                   const geom::Frame& frame);
  void refuse_patches(const geom::Frame& frame) const;
  void find_nodes(std::span<const CellCut> cuts);

  const mesh::Mesh& mesh_;
  const crack::CrackSet& cracks_;
  std::vector<PieceCut> ends_;       // that count, ascending by cell
  std::vector<Index> nodes_;         // natural numbers, ascending
  Pieces pieces_;                    // by places in the gathered cells, and nodes
  std::vector<Index> place_of_cell_; // per local cell: in pieces_.cells, -1 for none
  int codes_ = 0;
};
} // namespace pdx::xfem
