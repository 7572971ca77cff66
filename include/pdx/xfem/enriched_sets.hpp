#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/mesh/mesh.hpp"
#include "pdx/xfem/pieces.hpp"

namespace pdx::xfem {
/// The enriched set of a node for one crack: its second row. Where cracks meet, one for each body of its support that
/// does not hold the node.
struct EnrichedSet {
  int crack =
      0; ///< between node and body; from the number of cracks on: several are, or other bodies lie across it too
  PetscInt row = -1;            ///< global; -1 until `number`
  Side side = Side::plus;       ///< of the node: H(x_i)
  std::optional<Vector<2>> far; ///< where cracks meet: a place in the body, near to the node [m]
};

/// A local cell that a crack cuts, as element. Around nodes of cells that several cracks cut, one of its pieces.
struct CutElement {
  Index cell = 0;
  int crack = 0;
  std::optional<Side> snapped; ///< a sliver so small that the whole cell moves with this side
  CornerDistances distance; ///< of its corners; those within the tolerance of the crack count as on the plus side [m]
  EnrichedElement element;
  std::array<PetscInt, 4> sets{-1, -1, -1, -1}; ///< global row of each corner's set, -1 for none or before `number`
  std::optional<Piece> piece = {};              ///< what it is of the cell, if it is a piece; all on the plus side
};

class JunctionZone;

/// What cutting a mesh came to, on all ranks.
struct CutReport {
  Index cells = 0, sets = 0;
  Index dropped = 0;             ///< nodes left without a set because a side has too little of their support
  std::vector<Vector<2>> closed; ///< tips that end in elements: the crack closes at the last cut edge before them [m]
};

/// Which cells of a distributed mesh the cracks cut, and which enriched sets its nodes have [XPD1 Eqs. 10-12]. The
/// same answer on any number of ranks.
class EnrichedSets {
public:
  /// Cuts the plain cells (Use::cut from then on; covered ones stay as they are: bonds carry their cracks, and a crack
  /// that runs on into one is open where it leaves the elements). A crack within 1e-9 of the mesh's smallest edge of a
  /// node passes on the node's right. Where several part a cell or meet on its border, or one bends in it, nodes have
  /// copies by pieces (`cut_in_pieces`), but for cells with one crack that touch a patch: there it is straight. Throws
  /// UserError where a cell that several part touches a patch. `cracks` must outlive this. Collective.
  EnrichedSets(mesh::Mesh& mesh, const crack::CrackSet& cracks, const EnrichmentRule& rule,
               const geom::Frame& frame = {});

  /// Sets of owned vertices, in order of rows: ascending local vertex, then crack.
  Index owned() const { return static_cast<Index>(vertices_.size()); }
  std::span<const Index> vertices() const { return vertices_; } ///< local vertex of each owned set
  /// Owned set k has global row first + k; tells it to the ranks that have copies. Collective.
  void number(PetscInt first);
  std::span<const EnrichedSet> of(Index vertex) const; ///< all sets of a local vertex, halo included, by crack

  std::span<const CutElement> cells() const { return cells_; } ///< local cut cells, their pieces, ascending by cell
  const CutElement* cut(Index cell) const;                     ///< of a local cell; nullptr if no crack cuts it
  std::span<const CutElement> all_of(Index cell) const;        ///< more than one if it is in pieces
  /// What of a cut cell holds a point, and on which side it is there. Exact for one crack, else as pieces are drawn.
  std::pair<const CutElement*, Side> at(Index cell, const Vector<2>& x) const;
  int codes() const { return codes_; } ///< `EnrichedSet::crack` is below this
  const CutReport& report() const { return report_; }
  const crack::CrackSet& cracks() const { return *cracks_; }
  /// The same cracks stand elsewhere from now on.
  void look_at(const crack::CrackSet& cracks) { cracks_ = &cracks; }
  /// Side of a point of a cut cell, which moves as a whole if snapped. Exact, as for bonds: no tolerance.
  Side side_in(const CutElement& cut, const Vector<2>& x) const;

private:
  void keep_sets(const Enrichment& enrichment, const JunctionZone& zone);
  void keep_cells(const MeshView& view, std::span<const CellCut> cuts, const Enrichment& enrichment,
                  Quadrature quadrature, const JunctionZone& zone);
  void keep_pieces(const JunctionZone& zone, std::span<const CellCut> cuts);
  void count(const Enrichment& enrichment, const JunctionZone& zone);
  EnrichedSet* find(Index vertex, int crack);

  const mesh::Mesh& mesh_;
  const crack::CrackSet* cracks_;
  std::vector<Index> vertices_;
  std::vector<std::size_t> offsets_; // per local vertex, into sets_
  std::vector<EnrichedSet> sets_;
  std::vector<CutElement> cells_;
  CutReport report_;
  int codes_ = 0;
};

/// What the corner a of a cut element adds to the displacement on `side`: u_i + factor * set; 0 on its own side or
/// without a set [XPD1 Eq. 12].
inline double set_factor(const CutElement& cut, std::size_t a, Side side)
{
  return cut.sets[a] < 0 ? 0.0 : cut.element.factor(a, side);
}
} // namespace pdx::xfem
