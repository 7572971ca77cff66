#include "pdx/mesh/gmsh.hpp"
#include "pdx/base/petsc.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <petscdmplex.h>
#include <span>

namespace pdx::mesh {
namespace {
[[noreturn]] void refuse(const std::string& file, const std::string& what)
{
  throw UserError(fmt::format("-mesh_file {}: {}", file, what));
}

/// While alive, PETSc reads options from here and not from the user's database.
class PrivateOptions {
public:
  PrivateOptions()
  {
    PDX_CALL(PetscOptionsCreate(&options_));
    PDX_CALL(PetscOptionsPush(options_));
  }
  ~PrivateOptions()
  {
    (void)PetscOptionsPop();
    (void)PetscOptionsDestroy(&options_);
  }
  PrivateOptions(const PrivateOptions&) = delete;
  PrivateOptions& operator=(const PrivateOptions&) = delete;
  void set(const char* name, const char* value) { PDX_CALL(PetscOptionsSetValue(options_, name, value)); }

private:
  PetscOptions options_ = nullptr;
};

DmHandle read_plex(const std::string& file)
{
  PrivateOptions options;
  options.set("-dm_plex_gmsh_use_regions", "true"); // labels by physical names
  options.set("-dm_plex_gmsh_spacedim", "3");       // or a tilted plane would pass for a flat one
  DmHandle plex;
  if (DMPlexCreateGmshFromFile(PETSC_COMM_SELF, file.c_str(), PETSC_TRUE, plex.out())) {
    std::string message = take_petsc_message();
    std::replace(message.begin(), message.end(), '\n', ' ');
    refuse(file, fmt::format("the file is broken ({}): write it again", message));
  }
  return plex;
}

struct Strata {
  PetscInt cells = 0; ///< cells are the points 0 ... cells - 1
  PetscInt first_edge = 0, end_edge = 0, first_vertex = 0, end_vertex = 0;
  bool vertex(PetscInt p) const { return p >= first_vertex && p < end_vertex; }
};

Strata require_quadrilaterals(DM plex, const std::string& file)
{
  PetscInt dimension = 0, first = 0;
  PDX_CALL(DMGetDimension(plex, &dimension));
  if (dimension != 2) refuse(file, "has no four-node cells: mesh the surface and save its elements");
  Strata strata;
  PDX_CALL(DMPlexGetDepthStratum(plex, 2, &first, &strata.cells));
  PDX_CALL(DMPlexGetDepthStratum(plex, 1, &strata.first_edge, &strata.end_edge));
  PDX_CALL(DMPlexGetDepthStratum(plex, 0, &strata.first_vertex, &strata.end_vertex));
  if (strata.cells == first) refuse(file, "has no four-node cells: mesh the surface and save its elements");
  for (PetscInt c = first; c < strata.cells; ++c) {
    DMPolytopeType type = DM_POLYTOPE_UNKNOWN;
    PDX_CALL(DMPlexGetCellType(plex, c, &type));
    if (type != DM_POLYTOPE_QUADRILATERAL)
      refuse(file, "has cells that are no quadrilaterals: recombine the surface in Gmsh");
  }
  return strata;
}

/// Cells and the vertices they use; `vertex` gives the number of a plex vertex, -1 if no cell uses it.
void take_cells(DM plex, const Strata& strata, CellList& list, std::vector<Index>& vertex)
{
  vertex.assign(static_cast<std::size_t>(strata.end_vertex - strata.first_vertex), -1);
  PetscInt size = 0, *closure = nullptr;
  for (PetscInt c = 0; c < strata.cells; ++c) {
    PDX_CALL(DMPlexGetTransitiveClosure(plex, c, PETSC_TRUE, &size, &closure));
    std::array<Index, 4> cell{};
    std::size_t corner = 0;
    for (PetscInt k = 0; k < size; ++k)
      if (strata.vertex(closure[2 * k])) cell[corner++] = closure[2 * k] - strata.first_vertex;
    for (Index v : cell) vertex[static_cast<std::size_t>(v)] = 0;
    list.cells.push_back(cell);
  }
  if (closure) PDX_CALL(DMPlexRestoreTransitiveClosure(plex, 0, PETSC_TRUE, &size, &closure));
  Index used = 0;
  for (Index& v : vertex)
    if (v == 0) v = used++;
  for (auto& cell : list.cells)
    for (Index& v : cell) v = vertex[static_cast<std::size_t>(v)];
}

void take_points(DM plex, const Strata& strata, std::span<const Index> vertex, const std::string& file, CellList& list)
{
  PetscSection section = nullptr;
  Vec coordinates = nullptr;
  const PetscScalar* x = nullptr;
  PDX_CALL(DMGetCoordinateSection(plex, &section));
  PDX_CALL(DMGetCoordinatesLocal(plex, &coordinates));
  std::vector<Vector<3>> points;
  PDX_CALL(VecGetArrayRead(coordinates, &x));
  for (PetscInt v = strata.first_vertex; v < strata.end_vertex; ++v) {
    PetscInt dofs = 0, offset = 0;
    PDX_CALL(PetscSectionGetDof(section, v, &dofs));
    PDX_CALL(PetscSectionGetOffset(section, v, &offset));
    if (vertex[static_cast<std::size_t>(v - strata.first_vertex)] < 0) continue;
    points.emplace_back(x[offset], x[offset + 1], dofs > 2 ? x[offset + 2] : 0.0);
  }
  PDX_CALL(VecRestoreArrayRead(coordinates, &x));
  Vector<3> lower = points.front(), upper = points.front();
  for (const auto& p : points) {
    if (!p.allFinite()) refuse(file, "a coordinate is no finite number: write it again");
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
    list.points.push_back(p.head<2>());
  }
  if (upper[2] - lower[2] > 1e-9 * (upper - lower).head<2>().maxCoeff())
    refuse(file,
           fmt::format("z runs from {} to {} m: the mesh must lie in one plane z = constant", lower[2], upper[2]));
}

double cross(const Vector<2>& a, const Vector<2>& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Turns clockwise cells; refuses those whose corners do not all bend to the left then.
void orient_cells(const std::string& file, CellList& list)
{
  for (std::size_t c = 0; c < list.cells.size(); ++c) {
    auto& cell = list.cells[c];
    std::array<Vector<2>, 4> x;
    const auto fetch = [&] {
      for (std::size_t k = 0; k < 4; ++k) x[k] = list.points[static_cast<std::size_t>(cell[k])];
    };
    fetch();
    if (cross(x[2] - x[0], x[3] - x[1]) < 0.0) {
      std::swap(cell[1], cell[3]);
      fetch();
    }
    const double scale = std::max((x[2] - x[0]).squaredNorm(), (x[3] - x[1]).squaredNorm());
    for (std::size_t k = 0; k < 4; ++k)
      if (!(cross(x[(k + 1) % 4] - x[k], x[(k + 3) % 4] - x[k]) > 1e-12 * scale))
        refuse(file, fmt::format("cell {} (counted from 1) is degenerate at ({}, {}) m: its corner there is not below "
                                 "180 degrees; mend the mesh",
                                 c + 1, x[k][0], x[k][1]));
  }
}

/// Labels that name physical curves: all but those PETSc makes itself.
std::map<std::string, DMLabel> physical_groups(DM plex)
{
  std::map<std::string, DMLabel> groups;
  PetscInt count = 0;
  PDX_CALL(DMGetNumLabels(plex, &count));
  for (PetscInt k = 0; k < count; ++k) {
    const char* name = nullptr;
    PDX_CALL(DMGetLabelName(plex, k, &name));
    constexpr const char* own[] = {"depth", "celltype", "Cell Sets", "Face Sets", "Vertex Sets"};
    if (std::find(std::begin(own), std::end(own), std::string_view(name)) != std::end(own)) continue;
    PDX_CALL(DMGetLabel(plex, name, &groups[name]));
  }
  return groups;
}

void take_edges(DM plex, const Strata& strata, std::span<const Index> vertex, const std::string& file, CellList& list)
{
  const auto groups = physical_groups(plex);
  std::map<std::string, std::vector<std::array<Index, 2>>> edges;
  for (PetscInt e = strata.first_edge; e < strata.end_edge; ++e) {
    PetscInt cells = 0;
    const PetscInt* ends = nullptr;
    PDX_CALL(DMPlexGetSupportSize(plex, e, &cells));
    if (cells > 2) refuse(file, "more than two cells share an edge: remove duplicate surfaces");
    if (cells != 1) continue;
    PDX_CALL(DMPlexGetCone(plex, e, &ends));
    const std::array<Index, 2> edge{vertex[static_cast<std::size_t>(ends[0] - strata.first_vertex)],
                                    vertex[static_cast<std::size_t>(ends[1] - strata.first_vertex)]};
    bool named = false;
    for (const auto& [name, label] : groups) {
      PetscInt value = -1;
      PDX_CALL(DMLabelGetValue(label, e, &value));
      if (value >= 0) edges[name].push_back(edge);
      named = named || value >= 0;
    }
    if (!named) edges["unnamed"].push_back(edge);
  }
  for (const auto& [name, group] : edges) {
    for (const auto& edge : group) list.edges.push_back({edge, static_cast<Index>(list.boundaries.size())});
    list.boundaries.push_back(name);
  }
}
} // namespace

CellList read_gmsh(const std::string& file)
{
  scan_gmsh(file);
  const DmHandle plex = read_plex(file);
  const Strata strata = require_quadrilaterals(plex.get(), file);
  CellList list;
  std::vector<Index> vertex;
  take_cells(plex.get(), strata, list, vertex);
  take_points(plex.get(), strata, vertex, file, list);
  orient_cells(file, list);
  take_edges(plex.get(), strata, vertex, file, list);
  return list;
}
} // namespace pdx::mesh
