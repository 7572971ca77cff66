#include "support/gmsh_writer.hpp"
#include "support/mesh_files.hpp"

#include "pdx/base/error.hpp"
#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <sys/stat.h>
#include <unistd.h>

using namespace pdx::mesh;

namespace {
/// A file in the temporary directory, gone at the end of the test.
class TemporaryFile {
public:
  explicit TemporaryFile(const std::string& text)
      : path_((std::filesystem::temp_directory_path() / ("pdx_gmsh_" + std::to_string(getpid()) + ".msh")).string())
  {
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~TemporaryFile()
  {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

private:
  std::string path_;
};

/// What a text is refused for, "" if it is read.
std::string refusal(const std::string& text)
{
  const TemporaryFile file(text);
  try {
    (void)read_gmsh(file.path());
  } catch (const pdx::UserError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_EQ(what.find("-mesh_file " + file.path()), 0u) << what;
    return what;
  }
  return "";
}

void expect_refused(const std::string& text, const char* reason)
{
  const std::string what = refusal(text);
  EXPECT_NE(what.find(reason), std::string::npos) << "got: " << what;
}

double area(const CellList& list, std::size_t c)
{
  double twice = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& a = list.points[static_cast<std::size_t>(list.cells[c][k])];
    const auto& b = list.points[static_cast<std::size_t>(list.cells[c][(k + 1) % 4])];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}
} // namespace

TEST(MeshGmsh, BothFormatsGiveTheSameCells)
{
  for (const std::string& text : {mesh_files::two_cells_22(), mesh_files::two_cells_41()}) {
    const TemporaryFile file(text);
    const CellList list = read_gmsh(file.path());
    ASSERT_EQ(list.cells.size(), 2u);
    ASSERT_EQ(list.points.size(), 6u); // the seventh node belongs to no cell
    EXPECT_NEAR(area(list, 0), 1.0, 1e-15);
    EXPECT_NEAR(area(list, 1), 1.0, 1e-15); // clockwise in the file
    EXPECT_EQ(list.boundaries, (std::vector<std::string>{"left", "right", "unnamed"}));
    std::array<int, 3> edges{};
    for (const auto& edge : list.edges) ++edges[static_cast<std::size_t>(edge.name)];
    EXPECT_EQ(edges, (std::array<int, 3>{1, 1, 4}));
  }
}

TEST(MeshGmsh, EdgesWithoutNamedCurvesAreUnnamed)
{
  std::string text = mesh_files::two_cells_22();
  text.erase(text.find("$PhysicalNames"), text.find("$Nodes") - text.find("$PhysicalNames"));
  const TemporaryFile file(text);
  const CellList list = read_gmsh(file.path());
  EXPECT_EQ(list.boundaries, std::vector<std::string>{"unnamed"});
  EXPECT_EQ(list.edges.size(), 6u);
}

TEST(MeshGmsh, MissingFileIsRefused)
{
  EXPECT_THROW(read_gmsh("/nonexistent/plate.msh"), pdx::UserError);
  EXPECT_THROW(read_gmsh("/"), pdx::UserError);
}

TEST(MeshGmsh, EveryCutOffFileIsRefused)
{
  for (const std::string& text : {mesh_files::two_cells_22(), mesh_files::two_cells_41()})
    for (std::size_t size = 0; size + 2 < text.size(); size += 3)
      EXPECT_NE(refusal(text.substr(0, size)), "") << "cut off after " << size << " of " << text.size() << " bytes";
}

TEST(MeshGmsh, OtherCellsAreRefused)
{
  using mesh_files::replaced;
  const std::string text = mesh_files::two_cells_22(), cell = "6 3 2 1 1 2 5 6 3\n";
  expect_refused(replaced(text, cell, "6 2 2 1 1 2 3 6\n"), "triangles");
  expect_refused(replaced(text, cell, "6 10 2 1 1 2 3 6 5 1 2 3 4 5\n"), "higher order");
  expect_refused(replaced(text, cell, "6 5 2 1 1 1 2 3 4 5 6 7 1\n"), "type 5");
  expect_refused(mesh_files::without_cells_22(), "no four-node cells");
}

TEST(MeshGmsh, NonsenseIsRefused)
{
  using mesh_files::replaced;
  const std::string text = mesh_files::two_cells_22(), cell = "6 3 2 1 1 2 5 6 3\n";
  expect_refused("this is a shopping list\n", "no Gmsh file");
  expect_refused(replaced(text, "2.2 0 8", "1.0 0 8"), "format 1.0");
  expect_refused(replaced(text, cell, "6 3 2 1 1 2 5 6 99999999\n"), "node 99999999");
  expect_refused(replaced(text, cell, "6 3 2 1 1 2 5 six 3\n"), "\"six\"");
  expect_refused(replaced(text, "$Nodes\n7", "$Nodes\n-7"), "count of -7");
  expect_refused(replaced(text, "$Nodes\n7", "$Nodes\n6"), "\"7\" where $EndNodes");
  expect_refused(replaced(text, "$Nodes\n7", "$Nodes\n8"), "\"$EndNodes\"");
  expect_refused(replaced(text, "2 1 0 0.5", "2 one 0 0.5"), "\"one\"");
}

TEST(MeshGmsh, ErrorsNameTheLine)
{
  using mesh_files::replaced;
  const std::string text = mesh_files::two_cells_22();
  const auto lines = std::count(text.begin(), text.begin() + static_cast<long>(text.find("6 3 2 1")), '\n') + 1;
  expect_refused(replaced(text, "6 3 2 1 1 2 5 6 3\n", "6 3 2 1 1 2 5 6 35\n"),
                 ("line " + std::to_string(lines) + ":").c_str());
}

TEST(MeshGmsh, ShapesWithoutAMapAreRefused)
{
  using mesh_files::replaced;
  const std::string text = mesh_files::two_cells_22();
  expect_refused(replaced(text, "3 2 0 0.5", "3 0.5 0.6 0.5"), "degenerate");             // re-entrant corner
  expect_refused(replaced(text, "6 2 1 0.5", "6 1 1 0.5"), "degenerate");                 // two corners coincide
  expect_refused(replaced(text, "6 3 2 1 1 2 5 6 3", "6 3 2 1 1 2 6 5 3"), "degenerate"); // bow tie
  expect_refused(replaced(text, "6 2 1 0.5", "6 2 1 0.75"), "z runs from 0.5 to 0.75");
}

namespace {
/// Both ends of every edge of every boundary, as "x,y".
std::map<std::string, std::vector<std::array<double, 4>>> edges_by_name(const CellList& list)
{
  std::map<std::string, std::vector<std::array<double, 4>>> edges;
  for (const auto& edge : list.edges) {
    const auto& a = list.points[static_cast<std::size_t>(edge.vertices[0])];
    const auto& b = list.points[static_cast<std::size_t>(edge.vertices[1])];
    edges[list.boundaries[static_cast<std::size_t>(edge.name)]].push_back(
        {std::min(a[0], b[0]), std::min(a[1], b[1]), std::max(a[0], b[0]), std::max(a[1], b[1])});
  }
  for (auto& [name, group] : edges) std::sort(group.begin(), group.end());
  return edges;
}

std::vector<std::string> equal_tags()
{
  std::vector<std::string> files;
  for (const bool blocks : {false, true})
    for (const bool binary : {false, true}) files.push_back(mesh_files::EqualTags(blocks, binary).write());
  return files;
}
} // namespace

TEST(MeshGmsh, BoundariesArePhysicalCurvesWhateverElseHasTheirNumbers)
{
  using Edges = std::vector<std::array<double, 4>>;
  for (const std::string& text : equal_tags()) {
    const TemporaryFile file(text);
    const CellList list = read_gmsh(file.path());
    EXPECT_EQ(list.cells.size(), 2u); // in two physical surfaces
    const auto edges = edges_by_name(list);
    ASSERT_EQ(list.boundaries, (std::vector<std::string>{"bottom", "left", "right", "unnamed"}));
    EXPECT_EQ(edges.at("bottom"), (Edges{{0, 0, 1, 0}, {1, 0, 2, 0}}));
    EXPECT_EQ(edges.at("left"), (Edges{{0, 0, 0, 1}, {0, 0, 1, 0}, {1, 0, 2, 0}}));
    EXPECT_EQ(edges.at("right"), (Edges{{2, 0, 2, 1}}));
    EXPECT_EQ(edges.at("unnamed"), (Edges{{0, 1, 1, 1}, {1, 1, 2, 1}}));
  }
}

TEST(MeshGmsh, PartsOfAPartitionHaveTheirParentsGroups)
{
  using mesh_files::replaced;
  std::string text = mesh_files::two_cells_41(); // curve 2 becomes curve 12 of the partition, a part of curve 2
  text = replaced(text, "$EndEntities\n",
                  "$EndEntities\n$PartitionedEntities\n2\n1\n9 2\n0 1 0 0\n12 1 2 1 2 2 0 0.5 2 1 0.5 0 0\n"
                  "$EndPartitionedEntities\n");
  text = replaced(text, "1 2 1 1\n2 3 6", "1 12 1 1\n2 3 6");
  const TemporaryFile file(text);
  EXPECT_EQ(edges_by_name(read_gmsh(file.path())).at("right"), (std::vector<std::array<double, 4>>{{2, 0, 2, 1}}));
}

TEST(MeshGmsh, WhatSaysNothingOfTheMeshIsPassedOver)
{
  const std::string plain = mesh_files::two_cells_22();
  std::string text = "$Comments\nwritten by hand: $Nodes\n$Nodes\n$EndComments\n" + plain + "$Periodic\n1\n1 2 1\n0\n" +
                     "$EndPeriodic\n$NodeData\n1\n\"" + std::string(9000, 'x') + "\"\n$EndNodeData\n$Note\n$EndNote";
  EXPECT_EQ(refusal(text), "");
  EXPECT_EQ(refusal("\xef\xbb\xbf" + plain), ""); // UTF-8 mark
  for (const char* end : {"\r\n", "\r"}) {
    std::string lines;
    for (const char c : plain) lines += c == '\n' ? std::string(end) : std::string(1, c);
    EXPECT_EQ(refusal(lines), "");
  }
  EXPECT_EQ(refusal(mesh_files::replaced(plain, "1 1 2 1 1 1 4\n", "1 8 2 1 1 1 4 7\n")), ""); // a line of three nodes
}

TEST(MeshGmsh, DamagedBinaryFilesAreReadOrRefused)
{
  for (const bool blocks : {false, true}) {
    const std::string text = mesh_files::EqualTags(blocks, true).write();
    for (std::size_t size = 0; size + 2 < text.size(); size += 3)
      EXPECT_NE(refusal(text.substr(0, size)), "") << "cut off after " << size << " of " << text.size() << " bytes";
    for (std::size_t k = 0; k < text.size(); ++k)
      for (const char c : {'\x7f', '\xff', '\0'}) {
        std::string damaged = text;
        damaged[k] = c;
        EXPECT_LT(refusal(damaged).size(), 400u);
      }
  }
}

TEST(MeshGmsh, BinaryFilesOfOtherMachinesAreRefused)
{
  using mesh_files::replaced;
  const std::string text = mesh_files::EqualTags(true, true).write();
  expect_refused(replaced(text, std::string("\1\0\0\0", 4), std::string("\0\0\0\1", 4)), "byte order");
  expect_refused(replaced(text, "4.1 1 8", "4.1 1 4"), "4 bytes");
}

TEST(MeshGmsh, DamageIsNamed)
{
  using mesh_files::replaced;
  const std::string old = mesh_files::two_cells_22(), blocks = mesh_files::two_cells_41();
  expect_refused(replaced(old, "2 1 0 0.5\n", "2 nan 0 0.5\n"), "line 13: a coordinate is no finite number");
  expect_refused(replaced(old, "2 1 0 0.5\n", "2 1e999 0 0.5\n"), "\"1e999\" where a coordinate belongs");
  expect_refused(replaced(old, "2 1 0 0.5\n", "-2 1 0 0.5\n"), "line 13: a node has the number -2");
  expect_refused(replaced(old, "2 1 0 0.5\n", "1 1 0 0.5\n"), "node 1 twice");
  expect_refused(replaced(old, "$Elements\n6", "$Elements\n99999999999999999999"), "whole number");
  expect_refused(replaced(old, "$Elements\n6", "$Elements\n999999"), "count of 999999");
  expect_refused(replaced(old, "5 3 2 1 1", "5 3 -2 1 1"), "count of -2");
  expect_refused(replaced(old, "6 3 2 1 1 2 5 6 3", "6 3 2 1 1 2 5 6 " + std::string(5000, '3')), "whole number");
  expect_refused(replaced(old, "6 3 2 1 1 2 5 6 3", "6 3 2 1 1 1 2 5 4"), "the same nodes");
  expect_refused(replaced(old, "6 3 2 1 1 2 5 6 3", "6 3 2 1 1 1 2 6 4"), "the same side of an edge");
  expect_refused(old + "junk", "\"junk\" outside of all sections");
  expect_refused(old + "$Elements\n", "$Elements is there twice");
  expect_refused(old + "$Periodic\n", "$Periodic is not closed");
  expect_refused(replaced(old, "$EndMeshFormat\n", "$EndMeshFormat\n$Note\n"), "begins before $EndNote");
  expect_refused(old + "$Mesh\x1b[31mFormat\n", "$Mesh\\x1b[31mFormat");
  expect_refused(replaced(old, "1 1 \"left\"", "1 1 left"), "a name in quotes");
  expect_refused(replaced(old, "1 1 \"left\"", "7 1 \"left\""), "dimension 7");
  expect_refused(replaced(old, "1 1 \"left\"", "1 2 \"left\""), "named twice");
  expect_refused(replaced(blocks, "$Nodes\n2 7 1 7", "$Nodes\n2 6 1 7"), "6 nodes are announced, 7 are there");
  expect_refused(replaced(blocks, "$Elements\n4 5 1 5", "$Elements\n4 6 1 5"), "6 elements are announced");
  expect_refused(replaced(blocks, "1 1 1 1\n1 1 4", "2 1 1 1\n1 1 4"), "elements of dimension 1 in an entity");
  expect_refused(replaced(blocks, "1 2 1 1\n2 3 6", "1 8 1 1\n2 3 6"), "in curve 8, which is not in $Entities");
  const std::size_t begin = blocks.find("$Entities"), end = blocks.find("$Nodes");
  expect_refused(blocks.substr(0, begin) + blocks.substr(end), "no $Entities section");
}

TEST(MeshGmsh, OnlyRegularFilesAreOpened)
{
  const std::string pipe = (std::filesystem::temp_directory_path() / ("pdx_pipe_" + std::to_string(getpid()))).string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(read_gmsh(pipe), pdx::UserError); // and does not wait for somebody to write
  std::filesystem::remove(pipe);
  EXPECT_THROW(read_gmsh("/dev/zero"), pdx::UserError);
}
