#include "pdx/fem/stress_recovery.hpp"
#include "support/gmsh_grid.hpp"

#include <gtest/gtest.h>

namespace pdx::test::nodal_stress {
namespace {
const geom::Box<2> kBox{{0.0, 0.0}, {3.0, 2.0}};
const law::Elastic kLaw{200e9, 0.25, law::Plane::stress, 1e-3};
} // namespace

TEST(NodalStress, UniformStrainIsExactOnDistortedCellsWhateverTheirUse)
{
  mesh::Mesh mesh = test::grid_mesh(PETSC_COMM_WORLD, {kBox, {6, 4}, test::zigzag(kBox, {6, 4}, 0.2)});
  for (Index c = 0; c < mesh.cells(); ++c)
    if (mesh.centroid(c).x() > 1.5) mesh.cover(c, 0);
  std::vector<double> u;
  for (Index v = 0; v < mesh.vertices(); ++v) {
    u.push_back(1e-3 * mesh.point(v).x() + 2e-3 * mesh.point(v).y());
    u.push_back(-5e-4 * mesh.point(v).y());
  }
  const auto stress = fem::nodal_stress({mesh, kLaw, law::Kinematics::small}, u);
  ASSERT_EQ(stress.size(), 3 * static_cast<std::size_t>(mesh.owned_vertices()));
  const double expected[3] = {200e9 / 0.9375 * 8.75e-4, 200e9 / 0.9375 * -2.5e-4, 80e9 * 2e-3};
  for (std::size_t i = 0; i < stress.size(); ++i) EXPECT_NEAR(stress[i], expected[i % 3], 1e-4); // 1e-12 of it
}

TEST(NodalStress, IsTheMeanOfTheCellsAroundANode)
{
  // One row of two unit cells, nu = 0, stretched by 1e-3 and 3e-3: 1, 2 and 3 kPa for E = 1 MPa.
  const mesh::Mesh mesh = test::grid_mesh(PETSC_COMM_WORLD, {{{0.0, 0.0}, {2.0, 1.0}}, {2, 1}, {}});
  const law::Elastic law{1e6, 0.0, law::Plane::stress, 1.0};
  std::vector<double> u;
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const double x = mesh.point(v).x();
    u.push_back(x < 1.5 ? 1e-3 * x : 4e-3);
    u.push_back(0.0);
  }
  const auto stress = fem::nodal_stress({mesh, law, law::Kinematics::small}, u);
  for (Index v = 0; v < mesh.owned_vertices(); ++v)
    EXPECT_NEAR(stress[3 * static_cast<std::size_t>(v)], 1000.0 * (1.0 + mesh.point(v).x()), 1e-9);
}
} // namespace pdx::test::nodal_stress
