#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/mesh/mesh.hpp"
#include "pdx/xfem/pieces.hpp"

namespace pdx::xfem {
/// Is a cell neither a patch's nor one of points?
inline bool is_element(const mesh::Mesh& mesh, Index cell)
{
  return mesh.use(cell) != mesh::Use::covered && mesh.use(cell) != mesh::Use::points;
}

/// The cells around nodes of cells in which cracks meet or bend, and what becomes of them. The same on every rank.
class JunctionZone {
public:
  /// Finds the nodes: of cells that several cracks part, and, as far as no patch touches them, of cells that one bends
  /// in or that several meet on the border of, and nodes that one passes twice. Throws UserError for nodes that are a
  /// patch's too. Collective.
  /// @param view its active cells are the local elements   @param near owned elements, ascending by cell
  /// @param cuts cracks that run through local elements, ascending by cell   @param tolerance what is nearer is one
  /// place [m]
  JunctionZone(const mesh::Mesh& mesh, const crack::CrackSet& cracks, const MeshView& view,
               std::span<const NearCell> near, std::span<const CellCut> cuts, double tolerance,
               const geom::Frame& frame);
  bool empty() const { return nodes_.empty(); }
  /// Parts the cells, once it is known which are snapped. Collective.
  void part(std::span<const CellCut> cuts, const Snaps& snapped, double least_share);
  /// Snaps cells of which slivers were given up and that have nodes outside the zone: true if any, and then sets have
  /// to be found and cells parted once more.
  bool snap(const MeshView& view, std::span<const CellCut> cuts, Snaps& snapped) const;

  bool has_node(Index vertex) const; ///< local number; its sets are those of `copies`
  bool has_cell(Index cell) const { return place_of_cell_[static_cast<std::size_t>(cell)] >= 0; } ///< local number
  /// Pieces of a local cell that it has.
  const std::vector<Piece>& pieces(Index cell) const { return pieced(cell).pieces; }
  const CopiedNode& copies(Index vertex) const; ///< of a local vertex that it has
  int codes() const { return codes_; }          ///< of sets are below this number

private:
  void refuse_patches(const geom::Frame& frame) const;
  const PiecedCell& pieced(Index cell) const;
  void find_nodes(const MeshView& view, std::span<const NearCell> near, std::span<const CellCut> cuts);

  const mesh::Mesh& mesh_;
  const crack::CrackSet& cracks_;
  double tolerance_;
  std::vector<Index> nodes_;         // natural numbers, ascending
  Pieces pieces_;                    // by places in the gathered cells, and nodes
  std::vector<Index> place_of_cell_; // per local cell: in pieces_.cells, -1 for none
  int codes_ = 0;
};
} // namespace pdx::xfem
