#include "support/mesh_files.hpp"

#include "pdx/base/error.hpp"
#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
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
