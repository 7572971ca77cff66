#include "support/elastic_problem.hpp"
#include "support/gmsh_grid.hpp"

#include <gtest/gtest.h>

namespace pdx::test::loads {
namespace {
const law::Elastic kLaw{1.0, 0.25, law::Plane::stress, 0.5};
const geom::Box<2> kBox{{0.0, 0.0}, {3.0, 2.0}};

mesh::Mesh distorted() { return test::grid_mesh(PETSC_COMM_WORLD, {kBox, {6, 4}, test::zigzag(kBox, {6, 4}, 0.2)}); }

/// Total force (x, y) and moment about the origin, over all ranks.
std::array<double, 3> resultant(const mesh::Mesh& mesh, test::ElasticProblem& problem)
{
  std::array<double, 3> sum{0.0, 0.0, 0.0};
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    const PetscInt row = problem.node_rows()[static_cast<std::size_t>(v)];
    if (row < 0) continue;
    const double* f = &problem.force()[2 * static_cast<std::size_t>(row - problem.rows().first)];
    sum[0] += f[0];
    sum[1] += f[1];
    sum[2] += mesh.point(v).x() * f[1] - mesh.point(v).y() * f[0];
  }
  for (double& s : sum) s = test::sum_all(mesh.comm(), s);
  return sum;
}
} // namespace

TEST(Loads, TractionAddsUpToForceAndMomentOfTheSide)
{
  const mesh::Mesh mesh = distorted();
  test::ElasticProblem problem(mesh, kLaw, law::Kinematics::small);
  fem::add_traction(mesh, *mesh.boundary("right"), {5.0, -3.0}, kLaw.thickness, problem.loads());
  const auto sum = resultant(mesh, problem); // side of 2 m x 0.5 m at x = 3 m, centre at y = 1 m
  EXPECT_NEAR(sum[0], 5.0, 1e-13);
  EXPECT_NEAR(sum[1], -3.0, 1e-13);
  EXPECT_NEAR(sum[2], 3.0 * -3.0 - 1.0 * 5.0, 1e-13);
}

TEST(Loads, ConstantBodyForceAddsUpToWeightAtTheCentroid)
{
  const mesh::Mesh mesh = distorted();
  test::ElasticProblem problem(mesh, kLaw, law::Kinematics::small);
  fem::add_body_force(
      mesh, [](const Vector<2>&) { return Vector<2>(2.0, -1.0); }, kLaw.thickness, problem.loads());
  const auto sum = resultant(mesh, problem); // volume 3 m^3, centroid (1.5, 1)
  EXPECT_NEAR(sum[0], 6.0, 1e-13);
  EXPECT_NEAR(sum[1], -3.0, 1e-13);
  EXPECT_NEAR(sum[2], 1.5 * -3.0 - 1.0 * 6.0, 1e-13);
}

TEST(Loads, CoveredCellsTakeNoLoad)
{
  mesh::Mesh mesh = test::grid_mesh(PETSC_COMM_WORLD, {kBox, {6, 4}, {}});
  for (Index c = 0; c < mesh.cells(); ++c)
    if (mesh.centroid(c).y() > 1.5) mesh.cover(c, 0); // the upper row
  test::ElasticProblem problem(mesh, kLaw, law::Kinematics::small);
  fem::add_traction(mesh, *mesh.boundary("right"), {1.0, 0.0}, kLaw.thickness, problem.loads());
  fem::add_traction(mesh, *mesh.boundary("top"), {100.0, 0.0}, kLaw.thickness, problem.loads());
  fem::add_body_force(
      mesh, [](const Vector<2>&) { return Vector<2>(0.0, 2.0); }, kLaw.thickness, problem.loads());
  const auto sum = resultant(mesh, problem);
  EXPECT_NEAR(sum[0], 1.5 * 0.5, 1e-13);
  EXPECT_NEAR(sum[1], 2.0 * 3.0 * 1.5 * 0.5, 1e-13);
}
} // namespace pdx::test::loads
