#include "pdx/law/waves.hpp"

#include <cmath>
#include <gtest/gtest.h>

using pdx::law::Elastic;
using pdx::law::Plane;

namespace {
Elastic solid(double young, double poisson, double density, Plane plane = Plane::stress)
{
  return {.young = young, .poisson = poisson, .plane = plane, .density = density};
}
} // namespace

TEST(Waves, ThreeSpeedsOfThePapersMaterials)
{
  const Elastic steel = solid(192e9, 1.0 / 3.0, 7850.0), glass = solid(72e9, 1.0 / 3.0, 2440.0);
  EXPECT_NEAR(pdx::law::pressure_speed(steel), 5245.56, 0.005);
  EXPECT_NEAR(pdx::law::shear_speed(steel), 3028.53, 0.005);
  EXPECT_NEAR(pdx::law::rayleigh_speed(steel), 2784.43, 0.005);
  EXPECT_NEAR(pdx::law::pressure_speed(glass), 5761.66, 0.005);
  EXPECT_NEAR(pdx::law::shear_speed(glass), 3326.50, 0.005);
  EXPECT_NEAR(pdx::law::rayleigh_speed(glass), 3058.39, 0.005);
}

TEST(Waves, RayleighSpeedKnowsThePlaneProblem)
{
  EXPECT_NEAR(pdx::law::rayleigh_speed(solid(190e9, 1.0 / 3.0, 7800.0)), 2778.76, 0.005);
  EXPECT_NEAR(pdx::law::rayleigh_speed(solid(190e9, 0.25, 7800.0, Plane::strain)), 2869.89, 0.005);
}

TEST(Waves, RayleighSpeedOfAPoissonSolidIsTheClosedForm)
{
  const Elastic elastic = solid(5.0, 0.25, 1.0, Plane::strain); // c_S^2 = 2, c_L^2 = 6
  EXPECT_NEAR(pdx::law::rayleigh_speed(elastic), std::sqrt(2.0 * (2.0 - 2.0 / std::sqrt(3.0))), 1e-14);
}
