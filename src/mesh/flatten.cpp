#include "pdx/mesh/flatten.hpp"

#include <algorithm>
#include <petscdmplex.h>
#include <tuple>

namespace pdx::mesh {
namespace {
std::size_t at(PetscInt k) { return static_cast<std::size_t>(k); }

struct PointRange {
  PetscInt begin = 0, end = 0;
};

/// The plex while it is read: who owns its points and which local number they get.
struct Numbering {
  DM plex = nullptr;
  MPI_Comm comm = MPI_COMM_NULL;
  int rank = 0;
  PointRange cells, edges, vertices;
  std::vector<int> owner;   ///< per plex point
  std::vector<Index> local; ///< per plex point: flat number of the cell or vertex
};

std::vector<int> point_owners(DM plex, PetscInt points, int rank)
{
  std::vector<int> owner(at(points), rank);
  PetscSF sf = nullptr;
  PetscInt roots = 0, leaves = 0;
  const PetscInt* points_here = nullptr;
  const PetscSFNode* remote = nullptr;
  PDX_CALL(DMGetPointSF(plex, &sf));
  PDX_CALL(PetscSFGetGraph(sf, &roots, &leaves, &points_here, &remote));
  if (roots < 0) return owner; // no graph: one rank
  for (PetscInt k = 0; k < leaves; ++k) owner[at(points_here ? points_here[k] : k)] = static_cast<int>(remote[k].rank);
  return owner;
}

/// Points of a range, owned ones first, each part by ascending natural number; returns how many are owned.
std::pair<std::vector<PetscInt>, Index> in_order(const Numbering& n, PointRange range, std::span<const Index> natural)
{
  std::vector<PetscInt> points;
  for (PetscInt p = range.begin; p < range.end; ++p) points.push_back(p);
  std::sort(points.begin(), points.end(), [&](PetscInt a, PetscInt b) {
    return std::tuple(n.owner[at(a)] != n.rank, natural[at(a)]) < std::tuple(n.owner[at(b)] != n.rank, natural[at(b)]);
  });
  const auto owned = std::count_if(points.begin(), points.end(), [&](PetscInt p) { return n.owner[at(p)] == n.rank; });
  return {std::move(points), static_cast<Index>(owned)};
}

Numbering open_plex(DM plex)
{
  Numbering n;
  n.plex = plex;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(plex), &n.comm));
  MPI_Comm_rank(n.comm, &n.rank);
  PointRange chart;
  PDX_CALL(DMPlexGetChart(plex, &chart.begin, &chart.end));
  if (chart.end > chart.begin) { // an empty rank has no strata to ask for
    PDX_CALL(DMPlexGetDepthStratum(plex, 2, &n.cells.begin, &n.cells.end));
    PDX_CALL(DMPlexGetDepthStratum(plex, 1, &n.edges.begin, &n.edges.end));
    PDX_CALL(DMPlexGetDepthStratum(plex, 0, &n.vertices.begin, &n.vertices.end));
  }
  n.owner = point_owners(plex, chart.end, n.rank);
  n.local.assign(at(chart.end), -1);
  return n;
}

void number_points(Numbering& n, std::span<const Index> natural, MeshArrays& arrays)
{
  const auto [cells, owned_cells] = in_order(n, n.cells, natural);
  const auto [vertices, owned_vertices] = in_order(n, n.vertices, natural);
  arrays.owned_cells = owned_cells;
  arrays.owned_vertices = owned_vertices;
  for (PetscInt p : cells) {
    n.local[at(p)] = static_cast<Index>(arrays.natural_cell.size());
    arrays.natural_cell.push_back(natural[at(p)]);
    arrays.cell_owner.push_back(n.owner[at(p)]);
  }
  for (PetscInt p : vertices) {
    n.local[at(p)] = static_cast<Index>(arrays.natural_vertex.size());
    arrays.natural_vertex.push_back(natural[at(p)]);
  }
}

void take_cells(const Numbering& n, MeshArrays& arrays)
{
  arrays.cells.resize(arrays.natural_cell.size());
  PetscInt size = 0, *closure = nullptr;
  for (PetscInt c = n.cells.begin; c < n.cells.end; ++c) {
    PDX_CALL(DMPlexGetTransitiveClosure(n.plex, c, PETSC_TRUE, &size, &closure));
    auto& cell = arrays.cells[at(n.local[at(c)])];
    std::size_t corner = 0;
    for (PetscInt k = 0; k < size; ++k) {
      const PetscInt p = closure[2 * k];
      if (p >= n.vertices.begin && p < n.vertices.end) cell[corner++] = n.local[at(p)];
    }
    PDX_ASSERT(corner == 4);
  }
  if (closure) PDX_CALL(DMPlexRestoreTransitiveClosure(n.plex, 0, PETSC_TRUE, &size, &closure));
}

void take_points(const Numbering& n, MeshArrays& arrays)
{
  arrays.points.resize(arrays.natural_vertex.size());
  Vec coordinates = nullptr;
  PDX_CALL(DMGetCoordinatesLocal(n.plex, &coordinates));
  if (arrays.points.empty()) return;
  PetscSection section = nullptr;
  const PetscScalar* x = nullptr;
  PDX_CALL(DMGetCoordinateSection(n.plex, &section));
  PDX_CALL(VecGetArrayRead(coordinates, &x));
  for (PetscInt v = n.vertices.begin; v < n.vertices.end; ++v) {
    PetscInt offset = 0;
    PDX_CALL(PetscSectionGetOffset(section, v, &offset));
    arrays.points[at(n.local[at(v)])] = {x[offset], x[offset + 1]};
  }
  PDX_CALL(VecRestoreArrayRead(coordinates, &x));
}

BoundaryEdge boundary_edge(const Numbering& n, PetscInt edge, const MeshArrays& arrays)
{
  const PetscInt *ends = nullptr, *support = nullptr;
  PDX_CALL(DMPlexGetCone(n.plex, edge, &ends));
  PDX_CALL(DMPlexGetSupport(n.plex, edge, &support));
  const Index a = n.local[at(ends[0])], b = n.local[at(ends[1])], c = n.local[at(support[0])];
  const auto& cell = arrays.cells[at(c)];
  for (std::size_t k = 0; k < 4; ++k)
    if (cell[k] == a) return cell[(k + 1) % 4] == b ? BoundaryEdge{c, {a, b}} : BoundaryEdge{c, {b, a}};
  PDX_ASSERT(false);
  return {};
}

std::vector<PetscInt> stratum(DMLabel label, PetscInt value)
{
  std::vector<PetscInt> points;
  Handle<IS, ISDestroy> listed;
  if (label) PDX_CALL(DMLabelGetStratumIS(label, value, listed.out()));
  if (!listed) return points;
  PetscInt count = 0;
  const PetscInt* indices = nullptr;
  PDX_CALL(ISGetLocalSize(listed.get(), &count));
  PDX_CALL(ISGetIndices(listed.get(), &indices));
  points.assign(indices, indices + count);
  PDX_CALL(ISRestoreIndices(listed.get(), &indices));
  return points;
}

void take_boundaries(const Numbering& n, std::span<const std::string> names, MeshArrays& arrays)
{
  DMLabel label = nullptr;
  PDX_CALL(DMGetLabel(n.plex, kBoundaryLabel, &label));
  for (std::size_t k = 0; k < names.size(); ++k) {
    auto& edges = arrays.boundaries[names[k]];
    for (PetscInt e : stratum(label, static_cast<PetscInt>(k))) edges.push_back(boundary_edge(n, e, arrays));
    std::sort(edges.begin(), edges.end(), [](const BoundaryEdge& a, const BoundaryEdge& b) {
      return std::tuple(a.cell, a.vertices) < std::tuple(b.cell, b.vertices);
    });
  }
}

/// Owners tell their flat numbers through the plex' own SF; ours then connects flat numbers.
SfHandle connect_vertices(const Numbering& n, const MeshArrays& arrays)
{
  std::vector<Index> remote_local = n.local;
  PetscSF points = nullptr;
  PDX_CALL(DMGetPointSF(n.plex, &points));
  PetscInt roots = -1;
  PDX_CALL(PetscSFGetGraph(points, &roots, nullptr, nullptr, nullptr));
  if (roots >= 0) {
    PDX_CALL(PetscSFBcastBegin(points, MPI_INT, n.local.data(), remote_local.data(), MPI_REPLACE));
    PDX_CALL(PetscSFBcastEnd(points, MPI_INT, n.local.data(), remote_local.data(), MPI_REPLACE));
  }
  const std::size_t halo = arrays.points.size() - at(arrays.owned_vertices);
  std::vector<PetscInt> leaves(halo);
  std::vector<PetscSFNode> remote(halo);
  for (PetscInt v = n.vertices.begin; v < n.vertices.end; ++v) {
    const Index local = n.local[at(v)];
    if (local < arrays.owned_vertices) continue;
    leaves[at(local - arrays.owned_vertices)] = local;
    remote[at(local - arrays.owned_vertices)] = {n.owner[at(v)], remote_local[at(v)]};
  }
  SfHandle sf;
  PDX_CALL(PetscSFCreate(n.comm, sf.out()));
  PDX_CALL(PetscSFSetGraph(sf.get(), arrays.owned_vertices, static_cast<PetscInt>(halo), leaves.data(),
                           PETSC_COPY_VALUES, remote.data(), PETSC_COPY_VALUES));
  PDX_CALL(PetscSFSetUp(sf.get()));
  return sf;
}

/// Interior edges between cells of two ranks, counted by the lower rank.
Index count_cut(const Numbering& n)
{
  Index cut = 0;
  for (PetscInt e = n.edges.begin; e < n.edges.end; ++e) {
    PetscInt cells = 0;
    const PetscInt* support = nullptr;
    PDX_CALL(DMPlexGetSupportSize(n.plex, e, &cells));
    PDX_CALL(DMPlexGetSupport(n.plex, e, &support));
    if (cells != 2) continue;
    const auto [low, high] = std::minmax(n.owner[at(support[0])], n.owner[at(support[1])]);
    if (low == n.rank && high != n.rank) ++cut;
  }
  MPI_Allreduce(MPI_IN_PLACE, &cut, 1, MPI_INT, MPI_SUM, n.comm);
  return cut;
}

geom::Box<2> bounds(MPI_Comm comm, std::span<const Vector<2>> points)
{
  constexpr double far = std::numeric_limits<double>::infinity();
  geom::Box<2> box{Vector<2>(far, far), Vector<2>(-far, -far)};
  for (const auto& x : points) {
    box.lower = box.lower.cwiseMin(x);
    box.upper = box.upper.cwiseMax(x);
  }
  MPI_Allreduce(MPI_IN_PLACE, box.lower.data(), 2, MPI_DOUBLE, MPI_MIN, comm);
  MPI_Allreduce(MPI_IN_PLACE, box.upper.data(), 2, MPI_DOUBLE, MPI_MAX, comm);
  return box;
}
} // namespace

MeshArrays flatten(const DistributedPlex& distributed, std::span<const std::string> boundaries)
{
  Numbering n = open_plex(distributed.plex.get());
  MeshArrays arrays;
  number_points(n, distributed.natural, arrays);
  take_cells(n, arrays);
  take_points(n, arrays);
  take_boundaries(n, boundaries, arrays);
  arrays.vertex_sf = connect_vertices(n, arrays);
  MPI_Allreduce(&arrays.owned_cells, &arrays.global_cells, 1, MPI_INT, MPI_SUM, n.comm);
  MPI_Allreduce(&arrays.owned_vertices, &arrays.global_vertices, 1, MPI_INT, MPI_SUM, n.comm);
  arrays.bounds = bounds(n.comm, arrays.points);
  arrays.quality.cut = count_cut(n);
  return arrays;
}
} // namespace pdx::mesh
