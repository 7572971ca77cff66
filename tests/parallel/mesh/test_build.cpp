#include "pdx/mesh/build.hpp"
#include "support/ranks.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <petscdmplex.h>

using namespace pdx::mesh;
using pdx::Index;
using pdx::Vector;

using pdx::test::rank;
using pdx::test::ranks;

namespace {
template <class T> T sum(T value)
{
  const MPI_Datatype type = sizeof(T) == sizeof(double) ? MPI_DOUBLE : MPI_INT;
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, MPI_SUM, PETSC_COMM_WORLD);
  return value;
}

/// nx x ny cells of 0.5 m x 0.25 m with the lower left corner at (1, -1) m.
Mesh box(int nx, int ny, const CellCost& cost = {})
{
  MeshOptions options;
  options.box = {{1.0, -1.0}, {1.0 + 0.5 * nx, -1.0 + 0.25 * ny}};
  options.cells = {nx, ny};
  return build(PETSC_COMM_WORLD, options, cost);
}

double area(const std::array<Vector<2>, 4>& x)
{
  const Vector<2> a = x[2] - x[0], b = x[3] - x[1];
  return 0.5 * (a[0] * b[1] - a[1] * b[0]);
}

/// Everything that must hold of any nx x ny box, on any number of ranks.
void expect_box(const Mesh& mesh, int nx, int ny)
{
  EXPECT_EQ(mesh.global_cells(), nx * ny);
  EXPECT_EQ(mesh.global_vertices(), (nx + 1) * (ny + 1));
  EXPECT_EQ(sum(mesh.owned_cells()), nx * ny);
  EXPECT_EQ(sum(mesh.owned_vertices()), (nx + 1) * (ny + 1));
  EXPECT_LT((mesh.bounds().lower - Vector<2>(1.0, -1.0)).norm(), 1e-14);
  EXPECT_LT((mesh.bounds().upper - Vector<2>(1.0 + 0.5 * nx, -1.0 + 0.25 * ny)).norm(), 1e-14);
  double total = 0.0;
  for (Index c = 0; c < mesh.cells(); ++c) {
    EXPECT_NEAR(area(mesh.corners(c)), 0.125, 1e-14);
    EXPECT_EQ(mesh.cell_owner(c) == rank(), c < mesh.owned_cells());
    if (c < mesh.owned_cells()) total += area(mesh.corners(c));
  }
  EXPECT_NEAR(sum(total), 0.125 * nx * ny, 1e-12);
}

/// Natural numbers count rows of the box from the lower left, whatever the ranks.
void expect_natural_numbers(const Mesh& mesh, int nx)
{
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Index i = mesh.natural_vertex(v) % (nx + 1), j = mesh.natural_vertex(v) / (nx + 1);
    EXPECT_LT((mesh.point(v) - Vector<2>(1.0 + 0.5 * i, -1.0 + 0.25 * j)).norm(), 1e-14);
  }
  for (Index c = 0; c < mesh.cells(); ++c) {
    const Index first = mesh.natural_cell(c) % nx + mesh.natural_cell(c) / nx * (nx + 1);
    const std::array<Index, 4> expected{first, first + 1, first + nx + 2, first + nx + 1};
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(mesh.natural_vertex(mesh.cell(c)[k]), expected[k]);
  }
}

/// How often each number below `size` occurs on all ranks together.
template <class Number> std::vector<int> occurrences(Index size, Index count, Number number)
{
  std::vector<int> seen(static_cast<std::size_t>(size), 0);
  for (Index k = 0; k < count; ++k) ++seen[static_cast<std::size_t>(number(k))];
  MPI_Allreduce(MPI_IN_PLACE, seen.data(), size, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  return seen;
}

void expect_ascending(Index begin, Index end, const std::function<Index(Index)>& number)
{
  for (Index k = begin + 1; k < end; ++k) EXPECT_LT(number(k - 1), number(k));
}
} // namespace

TEST(MeshBuild, CellsFillTheBox) { expect_box(box(12, 9), 12, 9); }

TEST(MeshBuild, NaturalNumbersDoNotDependOnTheRanks) { expect_natural_numbers(box(12, 9), 12); }

TEST(MeshBuild, EveryNaturalNumberIsOwnedOnce)
{
  const Mesh mesh = box(7, 8);
  const auto cells = occurrences(56, mesh.owned_cells(), [&](Index c) { return mesh.natural_cell(c); });
  const auto vertices = occurrences(72, mesh.owned_vertices(), [&](Index v) { return mesh.natural_vertex(v); });
  EXPECT_EQ(cells, std::vector<int>(56, 1));
  EXPECT_EQ(vertices, std::vector<int>(72, 1));
}

TEST(MeshBuild, OwnedObjectsComeFirstInNaturalOrder)
{
  const Mesh mesh = box(9, 9);
  const auto cell = [&](Index c) { return mesh.natural_cell(c); };
  const auto vertex = [&](Index v) { return mesh.natural_vertex(v); };
  expect_ascending(0, mesh.owned_cells(), cell);
  expect_ascending(mesh.owned_cells(), mesh.cells(), cell);
  expect_ascending(0, mesh.owned_vertices(), vertex);
  expect_ascending(mesh.owned_vertices(), mesh.vertices(), vertex);
}

TEST(MeshBuild, EveryOwnedVertexHasAllItsCells)
{
  const int nx = 10, ny = 8;
  const Mesh mesh = box(nx, ny);
  std::vector<int> cells(static_cast<std::size_t>(mesh.vertices()), 0);
  for (Index c = 0; c < mesh.cells(); ++c)
    for (Index v : mesh.cell(c)) ++cells[static_cast<std::size_t>(v)];
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    const Index i = mesh.natural_vertex(v) % (nx + 1), j = mesh.natural_vertex(v) / (nx + 1);
    const int expected = (i == 0 || i == nx ? 1 : 2) * (j == 0 || j == ny ? 1 : 2);
    EXPECT_EQ(cells[static_cast<std::size_t>(v)], expected);
  }
}

TEST(MeshBuild, VertexSfBringsTheOwnersValues)
{
  const Mesh mesh = box(10, 6);
  std::vector<int> owned, all(static_cast<std::size_t>(mesh.vertices()), -1);
  for (Index v = 0; v < mesh.owned_vertices(); ++v) owned.push_back(mesh.natural_vertex(v));
  PDX_CALL(PetscSFBcastBegin(mesh.vertex_sf(), MPI_INT, owned.data(), all.data(), MPI_REPLACE));
  PDX_CALL(PetscSFBcastEnd(mesh.vertex_sf(), MPI_INT, owned.data(), all.data(), MPI_REPLACE));
  for (Index v = 0; v < mesh.vertices(); ++v)
    EXPECT_EQ(all[static_cast<std::size_t>(v)], v < mesh.owned_vertices() ? -1 : mesh.natural_vertex(v));
}

TEST(MeshBuild, BoundariesAreNamedAndLookOutward)
{
  const int nx = 6, ny = 4;
  const Mesh mesh = box(nx, ny);
  const std::map<std::string, std::pair<Vector<2>, int>> expected{
      {"left", {{-1, 0}, ny}}, {"right", {{1, 0}, ny}}, {"bottom", {{0, -1}, nx}}, {"top", {{0, 1}, nx}}};
  EXPECT_EQ(mesh.boundary_names().size(), 4u);
  for (const auto& [name, side] : expected) {
    ASSERT_NE(mesh.boundary(name), nullptr) << name;
    int owned = 0;
    for (const BoundaryEdge& edge : *mesh.boundary(name)) {
      const Vector<2> along = mesh.point(edge.vertices[1]) - mesh.point(edge.vertices[0]);
      EXPECT_LT((Vector<2>(along[1], -along[0]).normalized() - side.first).norm(), 1e-12) << name;
      const Vector<2> middle = 0.5 * (mesh.point(edge.vertices[0]) + mesh.point(edge.vertices[1]));
      EXPECT_GT((middle - mesh.centroid(edge.cell)).dot(side.first), 0.1) << name;
      owned += edge.cell < mesh.owned_cells();
    }
    EXPECT_EQ(sum(owned), side.second) << name;
  }
}

TEST(MeshBuild, OverlapKeepsItsBoundaryEdges)
{
  const int nx = 8, ny = 8;
  const Mesh mesh = box(nx, ny);
  int expected = 0;
  for (Index c = 0; c < mesh.cells(); ++c) expected += mesh.natural_cell(c) < nx;
  EXPECT_EQ(mesh.boundary("bottom")->size(), static_cast<std::size_t>(expected));
}

TEST(MeshBuild, CutCountsFacesBetweenRanks)
{
  const int nx = 12, ny = 10;
  const Mesh mesh = box(nx, ny);
  std::vector<int> owner(static_cast<std::size_t>(nx * ny), 0);
  for (Index c = 0; c < mesh.owned_cells(); ++c) owner[static_cast<std::size_t>(mesh.natural_cell(c))] = rank();
  MPI_Allreduce(MPI_IN_PLACE, owner.data(), nx * ny, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  int cut = 0;
  for (int c = 0; c < nx * ny; ++c) {
    const auto mine = owner[static_cast<std::size_t>(c)];
    if (c % nx + 1 < nx) cut += owner[static_cast<std::size_t>(c) + 1] != mine;
    if (c / nx + 1 < ny) cut += owner[static_cast<std::size_t>(c + nx)] != mine;
  }
  EXPECT_EQ(mesh.quality().cut, cut);
  if (ranks() == 2) {
    EXPECT_GE(cut, ny); // the shortest cut of a 12 x 10 box into halves
    EXPECT_LE(cut, 2 * ny);
  }
}

TEST(MeshBuild, MetisBalancesCellsOfUnequalCost)
{
  const auto cost = [](const std::array<Vector<2>, 4>& x) { return x[2][0] < 6.1 && x[2][1] < 1.6 ? 10 : 1; };
  const Mesh mesh = box(20, 20, cost); // a quarter of the cells, in one corner, costs 10
  constexpr int kTotal = 100 * 10 + 300;
  int mine = 0;
  for (Index c = 0; c < mesh.owned_cells(); ++c) mine += cost(mesh.corners(c));
  EXPECT_EQ(sum(mine), kTotal);
  EXPECT_LT(mesh.quality().imbalance, 1.08);
  int largest = mine;
  MPI_Allreduce(MPI_IN_PLACE, &largest, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_NEAR(mesh.quality().imbalance, largest * ranks() / static_cast<double>(kTotal), 1e-12);
}

TEST(MeshBuild, HugeCostsDoNotOverflow)
{
  const auto cost = [](const std::array<Vector<2>, 4>& x) { return x[2][0] < 6.1 ? 100'000'000 : 1; };
  EXPECT_LT(box(20, 20, cost).quality().imbalance, 1.08); // costs sum to 2e10
}

TEST(MeshBuild, EveryPartitionerCanBeChosen)
{
  for (const char* type : {"auto", "metis", "straight", "ptscotch", "simple"}) {
    PDX_CALL(PetscOptionsSetValue(nullptr, "-petscpartitioner_type", type));
    const Mesh mesh = box(8, 6);
    PDX_CALL(PetscOptionsClearValue(nullptr, "-petscpartitioner_type"));
    expect_box(mesh, 8, 6);
    expect_natural_numbers(mesh, 8);
    EXPECT_LT(mesh.quality().imbalance, 1.3) << type;
  }
}

TEST(MeshBuild, MoreRanksThanCellsIsFine)
{
  for (const auto& [nx, ny] : {std::pair(1, 1), std::pair(2, 1), std::pair(1, 3)})
    for (const char* type : {"auto", "metis", "straight", "ptscotch", "simple"}) {
      PDX_CALL(PetscOptionsSetValue(nullptr, "-petscpartitioner_type", type));
      const Mesh mesh = box(nx, ny);
      PDX_CALL(PetscOptionsClearValue(nullptr, "-petscpartitioner_type"));
      expect_box(mesh, nx, ny);
      expect_natural_numbers(mesh, nx);
      ASSERT_NE(mesh.boundary("top"), nullptr);
      int top = 0;
      for (const BoundaryEdge& edge : *mesh.boundary("top")) top += edge.cell < mesh.owned_cells();
      EXPECT_EQ(sum(top), nx);
    }
}

TEST(MeshBuild, SmallMeshesLeaveNoRankEmptyWithMetis)
{
  for (int nx = ranks(); nx < 12; ++nx) {
    const Mesh mesh = box(nx, 1);
    EXPECT_GT(mesh.owned_cells(), 0) << nx << " cells";
  }
}

TEST(MeshBuild, PlexStaysUndistributedByLaterOptions)
{
  const Mesh mesh = box(10, 10);
  PetscBool again = PETSC_TRUE;
  PDX_CALL(DMPlexDistributeGetDefault(mesh.plex(), &again));
  EXPECT_EQ(again, PETSC_FALSE);
}
