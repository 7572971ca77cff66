#include "pdx/mesh/cells_near.hpp"

#include "pdx/mesh/gmsh.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
mesh::MeshOptions plate() ///< 4 x 2 cells of .25 by .5 m
{
  mesh::MeshOptions options;
  options.box = {{1.0, 2.0}, {2.0, 3.0}};
  options.cells = {4, 2};
  return options;
}

/// The same as if it came from a file: rank 0 has the cells.
mesh::MeshOptions from_file()
{
  mesh::MeshOptions options = plate();
  options.file = "plate.msh";
  options.list = std::make_shared<mesh::CellList>();
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank) return options;
  for (int j = 0; j <= 2; ++j)
    for (int i = 0; i <= 4; ++i) options.list->points.emplace_back(1.0 + 0.25 * i, 2.0 + 0.5 * j);
  for (Index j = 0; j < 2; ++j)
    for (Index i = 0; i < 4; ++i)
      options.list->cells.push_back({5 * j + i, 5 * j + i + 1, 5 * j + i + 6, 5 * j + i + 5});
  return options;
}

std::size_t count(const mesh::MeshOptions& options, const geom::Box<2>& box)
{
  return mesh::cells_near(MPI_COMM_WORLD, options, box).size();
}
} // namespace

TEST(CellsNear, AreThoseInOrBesideABox)
{
  for (const mesh::MeshOptions& options : {plate(), from_file()}) {
    EXPECT_EQ(count(options, {{1.1, 2.1}, {1.1, 2.1}}), 1U);
    EXPECT_EQ(count(options, {{1.25, 2.1}, {1.25, 2.1}}), 2U);
    EXPECT_EQ(count(options, {{1.5, 2.5}, {1.5, 2.5}}), 4U);
    EXPECT_EQ(count(options, {{1.5 + 1e-9, 2.5}, {1.5, 2.5 - 1e-9}}), 4U);
    EXPECT_EQ(count(options, {{1.3, 2.1}, {1.6, 2.7}}), 4U);
    EXPECT_EQ(count(options, {{-9.0, -9.0}, {9.0, 9.0}}), 8U);
    EXPECT_EQ(count(options, {{1.0, 3.0}, {1.0, 3.0}}), 1U);
    EXPECT_EQ(count(options, {{1.1, 3.2}, {1.3, 3.3}}), 0U);
  }
}

TEST(CellsNear, AreTheSameFromAFile)
{
  const geom::Box<2> box{{1.2, 2.2}, {1.6, 2.9}};
  const auto a = mesh::cells_near(MPI_COMM_WORLD, plate(), box), b = mesh::cells_near(MPI_COMM_WORLD, from_file(), box);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t c = 0; c < a.size(); ++c)
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(a[c][k], b[c][k]);
}
