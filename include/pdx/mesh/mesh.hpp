#pragma once
#include "pdx/base/petsc.hpp"
#include "pdx/geom/box.hpp"
#include "pdx/mesh/cell_finder.hpp"

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pdx::mesh {
/// Who carries the physics of a cell: a plain element, an element that a crack cuts, the peridynamic patch that covers
/// it, or the material points in it.
enum class Use : std::uint8_t { plain, cut, covered, points };
inline constexpr std::size_t kUses = 4;

/// Edge on the outer boundary; seen from its cell the vertices run counter-clockwise (outward normal to the right).
struct BoundaryEdge {
  Index cell;
  std::array<Index, 2> vertices;
};

/// How METIS (or another partitioner) cut the mesh.
struct PartitionQuality {
  Index cut = 0;          ///< cell faces between ranks [-]
  double imbalance = 1.0; ///< largest rank's cost over the mean [-]
};

/// Flat arrays taken from the distributed DMPlex, filled by `build`. Local numbering: owned objects first, then the
/// overlap; every cell that touches an owned vertex is local. Natural ids do not depend on the number of ranks.
struct MeshArrays {
  Index owned_cells = 0, owned_vertices = 0;
  std::vector<std::array<Index, 4>> cells; ///< vertices of each local cell, counter-clockwise
  std::vector<Index> natural_cell;         ///< per local cell
  std::vector<int> cell_owner;             ///< rank per local cell
  std::vector<Vector<2>> points;           ///< per local vertex [m]
  std::vector<Index> natural_vertex;       ///< per local vertex
  std::map<std::string, std::vector<BoundaryEdge>, std::less<>> boundaries; ///< local edges by name (overlap included)
  SfHandle vertex_sf; ///< roots: owned vertices; leaves: halo vertices, by local index
  Index global_cells = 0, global_vertices = 0;
  geom::Box<2> bounds; ///< of the whole mesh [m]
  PartitionQuality quality;
};

/// The distributed background mesh of four-node cells: owns the DMPlex, knows cells, never physics. It covers the
/// whole domain; cells under a peridynamic patch are switched off by their Use, not removed.
class Mesh {
public:
  Mesh(DmHandle plex, MeshArrays arrays);

  MPI_Comm comm() const { return comm_; }
  DM plex() const { return plex_.get(); }
  Index owned_cells() const { return arrays_.owned_cells; }
  Index cells() const { return static_cast<Index>(arrays_.cells.size()); }
  Index owned_vertices() const { return arrays_.owned_vertices; }
  Index vertices() const { return static_cast<Index>(arrays_.points.size()); }
  Index global_cells() const { return arrays_.global_cells; }
  Index global_vertices() const { return arrays_.global_vertices; }

  const std::array<Index, 4>& cell(Index c) const { return arrays_.cells[static_cast<std::size_t>(c)]; }
  const Vector<2>& point(Index v) const { return arrays_.points[static_cast<std::size_t>(v)]; }
  Index natural_cell(Index c) const { return arrays_.natural_cell[static_cast<std::size_t>(c)]; }
  Index natural_vertex(Index v) const { return arrays_.natural_vertex[static_cast<std::size_t>(v)]; }
  int cell_owner(Index c) const { return arrays_.cell_owner[static_cast<std::size_t>(c)]; }
  std::array<Vector<2>, 4> corners(Index c) const;
  std::span<const std::array<Index, 4>> all_cells() const { return arrays_.cells; } ///< vertices of every local cell
  std::span<const Vector<2>> points() const { return arrays_.points; }              ///< of every local vertex [m]
  Vector<2> centroid(Index c) const;

  PetscSF vertex_sf() const { return arrays_.vertex_sf.get(); }
  const geom::Box<2>& bounds() const { return arrays_.bounds; }
  const PartitionQuality& quality() const { return arrays_.quality; }

  /// Local edges of a named boundary, or nullptr for an unknown name. Names are the same on every rank.
  const std::vector<BoundaryEdge>* boundary(std::string_view name) const;
  std::vector<std::string> boundary_names() const;

  Use use(Index c) const { return use_[static_cast<std::size_t>(c)]; }
  /// Number of the patch that covers cell c, -1 for an element.
  int patch(Index c) const { return patch_[static_cast<std::size_t>(c)]; }
  void cover(Index c, int patch);
  void uncover(Index c); ///< the cell is plain again, or one of points
  void cut(Index c);     ///< a plain cell becomes a cut one
  void uncover();        ///< makes every cell plain again, or one of points
  /// The body that a cell is of, 0 where nothing else was said: what lies near may be of another.
  Index body(Index c) const { return body_[static_cast<std::size_t>(c)]; }
  /// @param points material points fill it, not an element
  void set_body(Index c, Index body, bool points);
  /// Local cells of one use, overlap included: lists, so that loops carry no ifs.
  std::span<const Index> cells(Use use) const;
  const CellFinder& finder() const; ///< of all local cells; made when it is asked for

private:
  void set_use(Index c, Use use);
  MPI_Comm comm_;
  DmHandle plex_;
  MeshArrays arrays_;
  std::vector<Use> use_, uncovered_;
  std::vector<int> patch_;
  std::vector<Index> body_;
  mutable std::array<std::vector<Index>, kUses> lists_; // by use
  mutable bool listed_ = false;
  mutable std::vector<std::pair<Index, Use>> unlisted_; // cells of another use than lists know, and that one
  mutable std::optional<CellFinder> finder_;
};
} // namespace pdx::mesh
