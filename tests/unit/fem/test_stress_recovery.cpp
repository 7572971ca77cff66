#include "pdx/fem/stress_recovery.hpp"

#include "patch.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using law::Kinematics;

TEST(StressRecovery, UniformStrainGivesTheSameStressInEveryCornerOfADistortedCell)
{
  const Patch patch;
  const law::Elastic law{200e9, 0.25, law::Plane::stress, 1e-3};
  const Tensor<2> gradient{{1e-3, 2e-3}, {0.0, -5e-4}};
  // E / (1 - nu^2) (e_xx + nu e_yy) = 200e9 / 0.9375 * 8.75e-4, and so on by hand.
  const Eigen::Vector3d expected(200e9 / 0.9375 * 8.75e-4, 200e9 / 0.9375 * -2.5e-4, 80e9 * 2e-3);
  for (const auto& cell : patch.cells) {
    const auto stress = fem::corner_stress(patch.corners(cell), patch.linear(cell, gradient), law, Kinematics::small);
    for (int a = 0; a < 4; ++a) EXPECT_LT((stress.col(a) - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(StressRecovery, LinearStressInARectangleReachesItsCorners)
{
  // Pure bending u = (x y, -x^2 / 2), nu = 0: sigma_xx = E y. The four-node cell cannot bend: shear is spurious.
  const law::Elastic law{1.0, 0.0, law::Plane::stress, 1.0};
  const fem::Corners cell{{{-2, -1}, {2, -1}, {2, 1}, {-2, 1}}};
  fem::ElementVector d;
  for (int a = 0; a < 4; ++a) {
    const Vector<2>& x = cell[static_cast<std::size_t>(a)];
    d.segment<2>(2 * a) << x.x() * x.y(), -0.5 * x.x() * x.x();
  }
  const auto stress = fem::corner_stress(cell, d, law, Kinematics::small);
  for (int a = 0; a < 4; ++a) EXPECT_NEAR(stress(0, a), cell[static_cast<std::size_t>(a)].y(), 1e-14);
}

TEST(StressRecovery, FiniteStressIsForcePerDeformedArea)
{
  // Uniaxial plane stress, stretch 1.1 along x: S = E (1.1^2 - 1) / 2 = 0.105 E; section shrinks by 1 - 2 nu E_xx.
  const law::Elastic law{1.0, 0.3, law::Plane::stress, 1.0};
  const double stretch = 1.1, strain = 0.105, across = std::sqrt(1.0 - 2.0 * 0.3 * strain);
  const fem::Corners cell{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  fem::ElementVector d;
  d << 0, 0, stretch - 1.0, 0, stretch - 1.0, across - 1.0, 0, across - 1.0;
  const auto stress = fem::corner_stress(cell, d, law, Kinematics::finite);
  const double force = stretch * strain; // on a unit section of the reference body
  for (int a = 0; a < 4; ++a) {
    EXPECT_NEAR(stress(0, a), force / (across * across), 1e-14);
    EXPECT_NEAR(stress(1, a), 0.0, 1e-14);
    EXPECT_NEAR(stress(2, a), 0.0, 1e-14);
  }
}

TEST(StressRecovery, FiniteStressTurnsWithTheBody)
{
  const law::Elastic law{1.0, 0.3, law::Plane::strain, 1.0};
  const Patch patch;
  const Tensor<2> stretch{{1.05, 0.02}, {0.02, 0.97}}, quarter{{0.0, -1.0}, {1.0, 0.0}};
  const auto& cell = patch.cells[2];
  const auto straight = fem::corner_stress(patch.corners(cell), patch.linear(cell, stretch - Tensor<2>::Identity()),
                                           law, Kinematics::finite);
  const auto turned = fem::corner_stress(
      patch.corners(cell), patch.linear(cell, quarter * stretch - Tensor<2>::Identity()), law, Kinematics::finite);
  EXPECT_NEAR(turned(0, 0), straight(1, 0), 1e-14);
  EXPECT_NEAR(turned(1, 0), straight(0, 0), 1e-14);
  EXPECT_NEAR(turned(2, 0), -straight(2, 0), 1e-14);
  EXPECT_GT(std::abs(straight(0, 0) - straight(1, 0)), 1e-2);
}
