#include "pdx/fem/stress_recovery.hpp"
#include "support/elastic_problem.hpp"
#include "support/gmsh_grid.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using law::Kinematics;

namespace {
/// Bar of 2 m x 1 m on distorted cells, left side on rollers, lower left corner fixed.
struct Bar {
  geom::Box<2> box{{0.0, 0.0}, {2.0, 1.0}};
  mesh::Mesh mesh = test::grid_mesh(PETSC_COMM_WORLD, {box, {8, 5}, test::zigzag(box, {8, 5}, 0.2)});
  test::ElasticProblem problem;
  std::vector<double> u; ///< per local vertex [m]

  Bar(const law::Elastic& law, Kinematics kinematics, double traction) : problem(mesh, law, kinematics)
  {
    fem::add_traction(mesh, *mesh.boundary("right"), {traction, 0.0}, law.thickness, problem.loads());
    problem.prescribe([](const Vector<2>& x, int axis) -> std::optional<double> {
      const bool on_rollers = axis == 0 && x.x() < 1e-9, corner = x.norm() < 1e-9;
      return on_rollers || corner ? std::optional(0.0) : std::nullopt;
    });
    EXPECT_GT(problem.solve(), 0);
    u = problem.vertex_displacement();
  }
  void expect_stretch(double along, double across, double tolerance) const
  {
    for (Index v = 0; v < mesh.owned_vertices(); ++v) {
      const auto at = 2 * static_cast<std::size_t>(v);
      EXPECT_NEAR(u[at], (along - 1.0) * mesh.point(v).x(), tolerance);
      EXPECT_NEAR(u[at + 1], (across - 1.0) * mesh.point(v).y(), tolerance);
    }
  }
  void expect_stress(double sigma) const
  {
    const auto stress = fem::nodal_stress(problem.body(), u);
    for (Index v = 0; v < mesh.owned_vertices(); ++v) {
      const double* s = &stress[3 * static_cast<std::size_t>(v)];
      EXPECT_NEAR(s[0], sigma, 1e-8 * sigma);
      EXPECT_NEAR(s[1], 0.0, 1e-8 * sigma);
      EXPECT_NEAR(s[2], 0.0, 1e-8 * sigma);
    }
  }
};
} // namespace

TEST(UniaxialTension, SmallStrainFollowsHookeInPlaneStress)
{
  const Bar bar({200e9, 0.3, law::Plane::stress, 1e-3}, Kinematics::small, 100e6);
  bar.expect_stretch(1.0005, 1.0 - 0.3 * 0.0005, 1e-11); // sigma / E = 5e-4
  bar.expect_stress(100e6);
}

TEST(UniaxialTension, SmallStrainFollowsHookeInPlaneStrain)
{
  const Bar bar({200e9, 0.25, law::Plane::strain, 1e-3}, Kinematics::small, 100e6);
  // e_xx = (1 - nu^2) sigma / E, e_yy = -nu (1 + nu) sigma / E
  bar.expect_stretch(1.0 + 0.9375 * 5e-4, 1.0 - 0.3125 * 5e-4, 1e-11);
  bar.expect_stress(100e6);
}

TEST(UniaxialTension, EnergyIsHalfTheWorkOfTheLoad)
{
  Bar bar({200e9, 0.3, law::Plane::stress, 1e-3}, Kinematics::small, 100e6);
  const double energy = test::sum_all(PETSC_COMM_WORLD, bar.problem.term().energy(bar.problem.local_displacement()));
  EXPECT_NEAR(energy, 0.5 * 100e6 * 1e-3 * 1e-3, 1e-9 * 50.0); // 1/2 * 100 kN * 1 mm = 50 J
}

TEST(UniaxialTension, FiniteStrainFollowsStVenantKirchhoff)
{
  // Nominal stress P = E l (l^2 - 1) / 2: for l = 1.2 and E = 1 that is 0.264. E_yy = -nu E_xx.
  const double stretch = 1.2, strain = 0.22, across = std::sqrt(1.0 - 2.0 * 0.3 * strain);
  const Bar bar({1.0, 0.3, law::Plane::stress, 0.1}, Kinematics::finite, 0.264);
  bar.expect_stretch(stretch, across, 1e-9);
  bar.expect_stress(0.264 / (across * across)); // the section shrinks alike in both directions
}

namespace {
/// Cantilever [0, L] x [-D/2, D/2], force P up at x = L as a parabola of shear: exact plane-stress displacement
/// (Timoshenko and Goodier, Theory of Elasticity, art. 21; here per unit thickness, I = D^3 / 12).
struct Cantilever {
  double length = 8.0, depth = 1.0, force = 1e-3, young = 1.0, poisson = 0.25;
  Vector<2> exact(const Vector<2>& x) const
  {
    const double y = x.y(), l = length, d2 = depth * depth;
    const double scale = force / (6.0 * young * depth * d2 / 12.0);
    return {-scale * y * ((6.0 * l - 3.0 * x.x()) * x.x() + (2.0 + poisson) * (y * y - d2 / 4.0)),
            scale * (3.0 * poisson * y * y * (l - x.x()) + (4.0 + 5.0 * poisson) * d2 * x.x() / 4.0 +
                     (3.0 * l - x.x()) * x.x() * x.x())};
  }
};
struct CantileverResult {
  double deflection; ///< at mid span, on the centre line [m]
  double reaction;   ///< sum of vertical internal force at the clamp [N]
};

/// Left end as in the exact solution, a uniform shear traction of the same force on the right end.
CantileverResult bend(const Cantilever& beam, double thickness, Index rows)
{
  const geom::Box<2> box{{0.0, -0.5 * beam.depth}, {beam.length, 0.5 * beam.depth}};
  const mesh::Mesh mesh = test::grid_mesh(PETSC_COMM_WORLD, {box, {8 * rows, rows}, {}});
  test::ElasticProblem problem(mesh, {beam.young, beam.poisson, law::Plane::stress, thickness}, Kinematics::small);
  fem::add_traction(mesh, *mesh.boundary("right"), {0.0, beam.force / beam.depth}, thickness, problem.loads());
  problem.prescribe(
      [&](const Vector<2>& x, int axis) { return x.x() < 1e-9 ? std::optional(beam.exact(x)[axis]) : std::nullopt; });
  EXPECT_GT(problem.solve(), 0);
  const auto u = problem.vertex_displacement();
  const auto inner = problem.internal_force();
  CantileverResult mine{0.0, 0.0};
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    const auto row = problem.node_rows()[static_cast<std::size_t>(v)] - problem.rows().first;
    if ((mesh.point(v) - Vector<2>(0.5 * beam.length, 0.0)).norm() < 1e-9)
      mine.deflection += u[2 * static_cast<std::size_t>(v) + 1];
    if (mesh.point(v).x() < 1e-9) mine.reaction += inner[2 * static_cast<std::size_t>(row) + 1];
  }
  return {test::sum_all(PETSC_COMM_WORLD, mine.deflection), test::sum_all(PETSC_COMM_WORLD, mine.reaction)};
}
} // namespace

TEST(Cantilever, DeflectionConvergesToTheClosedFormAndTheClampCarriesTheLoad)
{
  const Cantilever beam;
  const double exact = beam.exact({0.5 * beam.length, 0.0}).y();
  const CantileverResult coarse = bend(beam, 0.1, 8), fine = bend(beam, 0.1, 16);
  EXPECT_LT(std::abs(fine.deflection / exact - 1.0), 3e-3);
  EXPECT_GT((coarse.deflection - exact) / (fine.deflection - exact), 3.6); // second order: 4
  EXPECT_NEAR(fine.reaction, -beam.force * 0.1, 1e-8 * beam.force);
}
