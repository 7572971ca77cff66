#pragma once
#include "pdx/couple/leaving.hpp"
#include "pdx/couple/patch_shape.hpp"
#include "pdx/field/row_shift.hpp"
#include "pdx/mesh/mesh.hpp"
#include "pdx/xfem/enriched_sets.hpp"

#include <optional>

namespace pdx::couple {
/// A point carried by rows: displacement = sum of weight times row. Nodes of an element or of the edges at the border
/// of a patch, and the enriched sets of those on the other side of a crack [XPD1 Eq. 14].
struct Host {
  static constexpr std::size_t kRows = 16;
  std::array<PetscInt, kRows> rows;  ///< global; the first `count`, as of what follows
  std::array<double, kRows> weights; ///< those of nodes sum to 1
  int count = 0;
  bool sided = false;  ///< a crack or seam enters there: moves with the side from which it is seen
  bool across = false; ///< moves, snapped, with the other side of a crack than it is on: bonds to it are cut
  int side = -1;       ///< of a patch's border: number of the straight side that it lies on

  /// Weights of the same rows where those of enriched sets hold the far half's w instead (`field::Tie`); sum to 1.
  std::array<double, kRows> tied;

  Host();
  void clear() ///< becomes a point that nothing carries
  {
    count = 0;
    sided = across = false;
    side = -1;
  }
  static Host of_row(PetscInt row);      ///< a row itself
  bool add(PetscInt row, double weight); ///< false if there is no room for another row
  /// Takes `weight` of a node that was added over to the other side of the crack: displacement + weight factor set.
  bool cross(PetscInt node, PetscInt set, double weight, double factor);
  bool mix(const Host& other); ///< becomes the mean of both; false, and of no use, if there is no room
};

inline Host::Host() = default; // hosts are made by the thousand: no zeros where there is no row

/// The elements of a scene, and what moves them.
struct ElementView {
  const mesh::Mesh& mesh;
  std::span<const PetscInt> node_rows; ///< global row of every local vertex, -1 under a patch
  const xfem::EnrichedSets* sets;      ///< numbered; null without cracks
};

/// A point of an element, on the side of its crack on which it lies [XPD2 Eq. 14].
Host host_in_cell(const ElementView& scene, Index cell, const Vector<2>& x);

/// What lies around one patch, the same on every rank: the mesh edges of its interface and the lattice sites outside
/// that have material, with the elements that hold them.
class Surroundings {
public:
  /// Surveys all patches at once. `band` = sites outside a patch that are looked at. Collective.
  /// @param sets  the mesh's enriched sets, numbered, or nullptr without cracks; must outlive the result
  /// @param seams where the mesh is parted, or nullptr; must outlive the result
  /// @param hosts shall `element_host` know what holds the sites outside?
  /// @param known of patches that stay, with what is around them: taken as they are. One for each patch, or none
  static std::vector<Surroundings> survey(const mesh::Mesh& mesh, std::span<const PatchShape> patches, Index band,
                                          std::span<const PetscInt> node_rows, const xfem::EnrichedSets* sets,
                                          const crack::CrackSet* seams = nullptr, bool hosts = true,
                                          std::vector<std::optional<Surroundings>> known = {});
  /// Nodes and sets have other rows from now on.
  void move_rows(const field::RowShift& shift);

  const PatchShape& shape() const { return shape_; }
  Index band() const { return band_; }
  /// True for a site of the lattice, or one in the band around it where the body has material.
  bool exists(const Site<2>& site) const;
  /// True for a site in the band where the body has material.
  bool outside(const Site<2>& site) const;
  /// True for a site outside the patch, in the body or not, that is reached through elements only: on every side of
  /// the patch in the band that it lies beyond there are elements, opposite or at the corner next to it.
  bool behind_elements(const Site<2>& site) const;
  /// The element that holds an outside site; count = 0 if no plain cell does, or hosts were not asked for.
  const Host& element_host(const Site<2>& site) const;
  /// What carries the point x in which a bond meets the border of the patch: the nodes of the mesh edges there. Where
  /// lattice cells and edges do not match, the trace of the edges is averaged over the lattice cell along the side.
  /// `inward` goes along the bond into the patch; where a crack enters it, x moves with the side on which x + inward
  /// lies. Empty where no elements lie behind, or a seam parts them from x + inward; no seam does where `inward` is 0.
  /// @param zone  lattice cells beside the body's free sides whose trace is averaged as that of one: bonds with surface
  /// factors share the tension out unevenly, but all in all as a uniform traction there
  std::optional<Host> edge_host(const Vector<2>& x, const Vector<2>& inward, Index zone = 0) const;
  /// Where a bond from a particle leaves through a straight side (`Host::side`).
  /// @param along direction of the bond [spacings], which meets the side there
  Leaving leaving(int side, const Site<2>& site, const std::array<double, 2>& along) const;
  /// From x to the nearest interface edge, infinite if there is none [m].
  double distance(const Vector<2>& x) const;
  /// Length of the shortest interface edge, infinite if there is none [m].
  double shortest_edge() const;
  /// Box around the interface edges that have a row of [first, end), empty if there are none.
  std::optional<geom::Box<2>> edges_of_rows(PetscInt first, PetscInt end) const;

private:
  struct Edge {
    double begin, end;                     // along the side [m]
    std::array<PetscInt, 2> rows;          // at begin and end
    int crack = -1;                        // that cuts the element behind
    std::array<PetscInt, 2> sets{-1, -1};  // enriched sets at begin and end
    std::array<xfem::Side, 2> node_side{}; // of begin and end
    int snapped = 0;                       // +-1: the element moves with that side as a whole
  };
  struct Trace;
  /// A straight piece of the patch's border.
  struct Side {
    geom::StraightSide line;
    double face = 0.0, start = 0.0; // where it lies across its axis, and where it starts along the other [m]
    std::vector<Edge> edges;        // ascending
    std::array<bool, 2> free_end{}; // the body ends where the side does, at its lower and upper end
    Index cells() const { return line.to - line.from; }
  };
  struct OutsideSite {
    int patch;
    Site<2> site;
  };
  struct EdgeRecord {
    int patch, side;
    Edge edge;
  };
  explicit Surroundings(PatchShape shape, Index band);
  std::size_t position(const Site<2>& site) const;
  void find_free_ends();
  static std::array<double, 2> zone_of(const Side& side, double cell, Index zone);
  bool host_on(const Side& side, const Vector<2>& x, const Vector<2>& inward, Index zone, Host& host) const;
  int side_of(const Vector<2>& a, const Vector<2>& b) const;
  bool in_band(const Site<2>& site) const;
  static Edge edge_of(const ElementView& scene, Index behind, std::array<Index, 2> vertices, Eigen::Index along);
  /// @param hosts what holds the sites; null: nobody asks
  static std::vector<OutsideSite> find_outside(const ElementView&, std::span<const Surroundings>,
                                               std::vector<Host>* hosts);
  static void find_edges(const ElementView&, std::span<const Surroundings>, std::vector<EdgeRecord>&);

  PatchShape shape_;
  Index band_;
  std::array<Index, 2> width_;
  std::vector<Index> where_; // per site of lattice and band: entry of hosts_ + 1, 0 = nothing there
  std::vector<Host> hosts_;
  std::vector<Side> sides_;
  std::array<std::vector<std::vector<std::size_t>>, 2> sides_on_; // numbers of those on each lattice line, by axis
  const crack::CrackSet *cracks_ = nullptr, *seams_ = nullptr;
  bool known_ = false; // looked at under another layout
};
} // namespace pdx::couple
