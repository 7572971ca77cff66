#include "support/mesh_files.hpp"

#include "pdx/mesh/build.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

using namespace pdx::mesh;
using pdx::Index;

namespace {
/// A file that the first rank writes and removes; only that rank can read it.
class SharedFile {
public:
  explicit SharedFile(const std::string& text)
      : path_((std::filesystem::temp_directory_path() / ("pdx_mesh_" + std::to_string(getpid()) + ".msh")).string())
  {
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank_);
    if (!rank_) std::ofstream(path_, std::ios::binary) << text;
  }
  ~SharedFile()
  {
    std::error_code ignored;
    if (!rank_) std::filesystem::remove(path_, ignored);
  }
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;
  const std::string& path() const { return path_; }

private:
  int rank_ = 0;
  std::string path_;
};

Mesh build_file(const std::string& path)
{
  MeshOptions options;
  options.file = path;
  return build(PETSC_COMM_WORLD, options, {});
}

int sum(int value)
{
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  return value;
}

int owned_edges(const Mesh& mesh, const char* name)
{
  int owned = 0;
  const auto* edges = mesh.boundary(name);
  if (!edges) return -1;
  for (const BoundaryEdge& edge : *edges) owned += edge.cell < mesh.owned_cells();
  return sum(owned);
}

/// n x n quadrilaterals in format 2.2, listed column by column; the right edges are the physical curve "pull".
std::string square_22(int n)
{
  std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 5 \"pull\"\n$EndPhysicalNames\n$Nodes\n";
  text += std::to_string((n + 1) * (n + 1)) + "\n";
  const auto node = [n](int i, int j) { return std::to_string(10 + i * (n + 1) + j); };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) text += node(i, j) + " " + std::to_string(i) + " " + std::to_string(j) + " 0\n";
  text += "$EndNodes\n$Elements\n" + std::to_string(n * n + n) + "\n";
  int number = 0;
  for (int j = 0; j < n; ++j) text += std::to_string(++number) + " 1 2 5 1 " + node(n, j) + " " + node(n, j + 1) + "\n";
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      text += std::to_string(++number) + " 3 2 1 1 " + node(i, j) + " " + node(i + 1, j) + " " + node(i + 1, j + 1) +
              " " + node(i, j + 1) + "\n";
  return text + "$EndElements\n";
}
} // namespace

TEST(MeshFile, BothFormatsBuildOnAnyNumberOfRanks)
{
  for (const std::string& text : {mesh_files::two_cells_22(), mesh_files::two_cells_41()}) {
    const SharedFile file(text);
    const Mesh mesh = build_file(file.path());
    EXPECT_EQ(mesh.global_cells(), 2);
    EXPECT_EQ(mesh.global_vertices(), 6);
    EXPECT_EQ(mesh.boundary_names(), (std::vector<std::string>{"left", "right", "unnamed"}));
    EXPECT_EQ(owned_edges(mesh, "left"), 1);
    EXPECT_EQ(owned_edges(mesh, "right"), 1);
    EXPECT_EQ(owned_edges(mesh, "unnamed"), 4);
    EXPECT_EQ(owned_edges(mesh, "plate"), -1);
    for (Index c = 0; c < mesh.cells(); ++c) {
      const auto x = mesh.corners(c);
      EXPECT_GT((x[1] - x[0]).x() * (x[2] - x[1]).y() - (x[1] - x[0]).y() * (x[2] - x[1]).x(), 0.0);
    }
  }
}

TEST(MeshFile, NaturalNumbersFollowTheFile)
{
  const int n = 7;
  const SharedFile file(square_22(n));
  const Mesh mesh = build_file(file.path());
  ASSERT_EQ(mesh.global_cells(), n * n);
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Index number = mesh.natural_vertex(v);
    EXPECT_EQ(mesh.point(v), pdx::Vector<2>(number / (n + 1), number % (n + 1)));
  }
  for (Index c = 0; c < mesh.cells(); ++c) {
    const Index number = mesh.natural_cell(c), column = number / n, row = number % n;
    EXPECT_LT((mesh.centroid(c) - pdx::Vector<2>(column + 0.5, row + 0.5)).norm(), 1e-14);
  }
  EXPECT_EQ(owned_edges(mesh, "pull"), n);
  EXPECT_EQ(owned_edges(mesh, "unnamed"), 3 * n);
  for (const BoundaryEdge& edge : *mesh.boundary("pull")) {
    EXPECT_EQ(mesh.point(edge.vertices[0]).x(), n);
    EXPECT_EQ(mesh.point(edge.vertices[1]).y() - mesh.point(edge.vertices[0]).y(), 1.0);
  }
}

TEST(MeshFile, EveryRankRefusesABadFileAlike)
{
  const std::string good = mesh_files::two_cells_41();
  const std::string triangles =
      mesh_files::replaced(mesh_files::two_cells_22(), "6 3 2 1 1 2 5 6 3", "6 2 2 1 1 2 5 6");
  for (const std::string& text : {good.substr(0, good.size() / 2), triangles, std::string("nonsense")}) {
    const SharedFile file(text);
    EXPECT_THROW(build_file(file.path()), pdx::UserError);
  }
  EXPECT_THROW(build_file("/nonexistent/plate.msh"), pdx::UserError);
}
