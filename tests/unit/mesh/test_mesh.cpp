#include "pdx/mesh/build.hpp"

#include <gtest/gtest.h>

using namespace pdx::mesh;
using pdx::Index;

namespace {
Mesh strip()
{
  MeshOptions options;
  options.box = {{0.0, 0.0}, {3.0, 1.0}};
  options.cells = {3, 1};
  return build(PETSC_COMM_WORLD, options, {});
}
} // namespace

TEST(MeshCells, AllArePlainAtFirst)
{
  const Mesh mesh = strip();
  EXPECT_EQ(mesh.cells(Use::plain).size(), 3u);
  EXPECT_TRUE(mesh.cells(Use::covered).empty());
  EXPECT_EQ(mesh.use(1), Use::plain);
  EXPECT_EQ(mesh.patch(1), -1);
}

TEST(MeshCells, CoveredOnesChangeTheirList)
{
  Mesh mesh = strip();
  EXPECT_EQ(mesh.cells(Use::plain).size(), 3u);
  mesh.cover(1, 4);
  ASSERT_EQ(mesh.cells(Use::covered).size(), 1u);
  EXPECT_EQ(mesh.cells(Use::covered)[0], 1);
  ASSERT_EQ(mesh.cells(Use::plain).size(), 2u);
  EXPECT_EQ(mesh.cells(Use::plain)[0], 0);
  EXPECT_EQ(mesh.cells(Use::plain)[1], 2);
  EXPECT_EQ(mesh.use(1), Use::covered);
  EXPECT_EQ(mesh.patch(1), 4);
}

TEST(MeshCells, KnowTheirCornersAndCentroid)
{
  const Mesh mesh = strip();
  EXPECT_EQ(mesh.centroid(2), pdx::Vector<2>(2.5, 0.5));
  EXPECT_EQ(mesh.corners(2)[0], pdx::Vector<2>(2.0, 0.0));
  EXPECT_EQ(mesh.corners(2)[2], pdx::Vector<2>(3.0, 1.0));
}

TEST(MeshCells, UnknownBoundaryIsNoBoundary)
{
  const Mesh mesh = strip();
  EXPECT_EQ(mesh.boundary("lefft"), nullptr);
  EXPECT_EQ(mesh.boundary_names(), (std::vector<std::string>{"bottom", "left", "right", "top"}));
  ASSERT_NE(mesh.boundary("right"), nullptr);
  EXPECT_EQ(mesh.boundary("right")->at(0).cell, 2);
}
