#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/xfem/enriched_element.hpp"

#include <optional>

namespace pdx::xfem {
/// The part of a mesh that elements act in, as plain arrays. Cells that are not `active` (covered by a patch) neither
/// hold enriched nodes back nor count as support.
struct MeshView {
  std::span<const std::array<Index, 4>> cells; ///< vertices of each cell, counter-clockwise
  std::span<const Vector<2>> points;           ///< of each vertex [m]
  std::span<const Index> active;               ///< numbers of cells

  fem::Corners corners(Index cell) const;
};

/// A cell that a crack cuts through.
struct CellCut {
  Index cell;
  int crack;
  CornerDistances distance; ///< of its corners from the crack, signed [m]; those of one vertex agree in sign
};

/// Which rows stay, and how cells are integrated. Grid points see a sliver only if it holds some, so that the grid
/// needs a larger share.
struct EnrichmentRule {
  double least_share = 1e-4; ///< of a node's support on either side, by area [-]
  Quadrature quadrature = Quadrature::polygons;

  static constexpr double kLeastGridShare = 2e-3; ///< about eight sub-cells of one of four cells
  double share() const { return quadrature == Quadrature::grid ? std::max(least_share, kLeastGridShare) : least_share; }
};

/// Why a node of a cut cell has no enriched row. share: a side has too little of its support, and goes to the other
/// half. tip: an edge of the node lets the crack into a cell that is not cut; the crack closes there.
enum class Verdict : std::uint8_t { enriched, share, tip };

/// A node whose support a crack cuts.
struct NodeSupport {
  int crack;
  Index node;
  Side side;      ///< where the node is, H(x_i)
  SideAreas area; ///< of the active cells around it [m^2]
  Verdict verdict = Verdict::enriched;
  Side lean = Side::plus; ///< verdict share: the side with more of the support, whose field u_i is
};

/// Per cut: the side that a snapped cell lies on as a whole.
using Snaps = std::vector<std::optional<Side>>;

/// The enriched rows and cut cells of a mesh.
struct Enrichment {
  std::vector<NodeSupport> nodes;   ///< enriched, ordered by crack, then by node
  std::vector<NodeSupport> dropped; ///< held without a row, in the same order
  Snaps snapped;                    ///< per cut
};

/// Enriches every node of every cut cell [XPD1 Eqs. 10-12], drops rows whose share of the support is below
/// `rule.share()` on one side, and closes tips. Where a row is dropped, the slivers in the cells around its node go to
/// the other half: the crack is moved by less than that share, so that both halves still move rigidly without force and
/// no unknown is left without stiffness. Moved slivers may leave other rows too little, hence repeated until quiet; a
/// sliver larger than that share of its nodes' supports never moves (unless its cell is smaller than that).
/// @param cuts at most one per cell and crack   @param snapped of each cut what is so already; none given: nothing
Enrichment enrich(const MeshView& view, std::span<const CellCut> cuts, const EnrichmentRule& rule = {},
                  Snaps snapped = {});

/// First cell that more than one crack cuts.
std::optional<Index> cell_of_two_cracks(std::span<const CellCut> cuts);

/// Numbers in `Enrichment::nodes` of the enriched sets of a cut cell's corners, -1 for none.
std::array<Index, 4> sets_of(const MeshView& view, const CellCut& cut, const Enrichment& enrichment);

/// The element of cut number `cut`.
EnrichedElement enriched_element(const MeshView& view, std::span<const CellCut> cuts, std::size_t cut,
                                 const Enrichment& enrichment, Quadrature quadrature);

/// The passes of `enrich`, for meshes whose nodes are shared between ranks: measure, judge, take the verdicts of shared
/// nodes from their owners, snap, again if any rank snapped; collect. Verdicts are right where all cells of the node
/// are in the view.
///@{
/// Supports of all nodes of cut cells, ordered by crack and node; tips are judged.
std::vector<NodeSupport> measure(const MeshView& view, std::span<const CellCut> cuts, const Snaps& snapped,
                                 Quadrature quadrature);
/// Sets the verdicts of nodes with too little on a side.
void judge(std::span<NodeSupport> supports, double least_share);
/// Gives slivers around dropped rows to the other half; true if any.
bool snap(const MeshView& view, std::span<const CellCut> cuts, std::span<const NodeSupport> supports, Snaps& snapped);
/// Parts nodes with a row from nodes without.
Enrichment collect(std::span<const NodeSupport> supports, Snaps snapped);
///@}
} // namespace pdx::xfem
