#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/geom/lattice.hpp"
#include "pdx/mesh/mesh.hpp"

#include <optional>

namespace pdx::couple {
/// Where one patch lies: its box is made of whole cells and of whole lattice cells.
struct PatchShape {
  geom::Box<2> box;
  geom::Lattice<2> lattice;
};

/// A point carried by at most four rows: displacement = sum of weight times row.
struct Host {
  std::array<PetscInt, 4> rows{-1, -1, -1, -1}; ///< global rows
  std::array<double, 4> weights{};              ///< sum to 1
  int count = 0;
};

/// What lies around one patch, the same on every rank: the mesh edges of its interface and the lattice sites outside
/// that have material, with the elements that hold them.
class Surroundings {
public:
  /// Surveys all patches at once. `band` = sites outside a patch that are looked at. Collective.
  /// Throws UserError if two patches touch.
  static std::vector<Surroundings> survey(const mesh::Mesh& mesh, std::span<const PatchShape> patches, Index band,
                                          std::span<const PetscInt> node_rows);

  const PatchShape& shape() const { return shape_; }
  Index band() const { return band_; }
  /// True for a site of the lattice, or one in the band around it where the body has material.
  bool exists(const Site<2>& site) const;
  /// True for a site in the band where the body has material.
  bool outside(const Site<2>& site) const;
  /// True for a site outside the patch, in the body or not, that is reached through elements only: on every side of
  /// the patch it lies beyond there are elements, opposite or at the corner next to it.
  bool behind_elements(const Site<2>& site) const;
  /// The element that holds an outside site; count = 0 if no plain cell does.
  const Host& element_host(const Site<2>& site) const;
  /// What carries the point x in which a bond meets the border of the patch: the nodes of the mesh edges there. Where
  /// lattice cells and edges do not match, the trace of the edges is averaged over the lattice cell along the side.
  /// `inward` points along the bond into the patch. Empty where no elements lie behind.
  std::optional<Host> edge_host(const Vector<2>& x, const Vector<2>& inward) const;
  /// Length of the shortest interface edge, infinite if there is none [m].
  double shortest_edge() const;
  /// Box around the interface edges that have a row of [first, end), empty if there are none.
  std::optional<geom::Box<2>> edges_of_rows(PetscInt first, PetscInt end) const;

private:
  struct Edge {
    double begin, end;            // along the side [m]
    std::array<PetscInt, 2> rows; // at begin and end
  };
  struct OutsideRecord {
    int patch;
    Site<2> site;
    Host host;
  };
  struct EdgeRecord {
    int patch, side;
    Edge edge;
  };
  explicit Surroundings(PatchShape shape, Index band);
  std::size_t position(const Site<2>& site) const;
  bool in_band(const Site<2>& site) const;
  static void find_outside(const mesh::Mesh&, std::span<const Surroundings>, std::span<const PetscInt> node_rows,
                           std::vector<OutsideRecord>&);
  static void find_edges(const mesh::Mesh&, std::span<const Surroundings>, std::span<const PetscInt> node_rows,
                         std::vector<EdgeRecord>&);

  PatchShape shape_;
  Index band_;
  std::array<Index, 2> width_;
  std::vector<Index> where_; // per site of lattice and band: entry of hosts_ + 1, 0 = nothing there
  std::vector<Host> hosts_;
  std::array<std::vector<Edge>, 4> sides_; // left, right, bottom, top; ascending
};
} // namespace pdx::couple
