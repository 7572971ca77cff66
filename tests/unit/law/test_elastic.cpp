#include "pdx/law/elastic.hpp"

#include <gtest/gtest.h>

using pdx::law::Elastic;
using pdx::law::Plane;

TEST(Elastic, PlaneStressHasNoStressAcross)
{
  const Elastic steel{.young = 9.0, .poisson = 1.0 / 3.0, .plane = Plane::stress};
  // E/(1 - nu^2) = 9 * 9/8, times nu, and E/(2 (1 + nu)) = 27/8
  EXPECT_DOUBLE_EQ(steel.c11(), 10.125);
  EXPECT_DOUBLE_EQ(steel.c12(), 3.375);
  EXPECT_DOUBLE_EQ(steel.mu(), 3.375);
}

TEST(Elastic, PlaneStrainHasNoStrainAcross)
{
  const Elastic solid{.young = 5.0, .poisson = 0.25, .plane = Plane::strain};
  EXPECT_DOUBLE_EQ(solid.c11(), 6.0); // E (1 - nu)/((1 + nu)(1 - 2 nu)) = 5 * .75/.625
  EXPECT_DOUBLE_EQ(solid.c12(), 2.0);
  EXPECT_DOUBLE_EQ(solid.mu(), 2.0);
}

TEST(Elastic, PullInPlaneStressStretchesByStressOverYoung)
{
  const Elastic solid{.young = 7.0, .poisson = 0.2, .plane = Plane::stress};
  const Eigen::Vector3d stress = solid.stiffness() * Eigen::Vector3d(1.0, -0.2, 0.0);
  EXPECT_NEAR(stress[0], 7.0, 1e-14);
  EXPECT_NEAR(stress[1], 0.0, 1e-14);
  EXPECT_DOUBLE_EQ((solid.stiffness() * Eigen::Vector3d(0, 0, 1.0))[2], 7.0 / 2.4);
}
