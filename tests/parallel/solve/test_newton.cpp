#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// Bent and stretched by a tenth of its length, in finite strain.
options::SceneOptions stretched_plate(couple::Scheme scheme)
{
  auto options = test::held_plate({12, 12});
  options.conditions.resize(2); // left and right
  options.conditions[1].displacement = {0.1, 0.05};
  options = test::with_patch(options, {{0.25, 0.25}, {0.75, 0.75}}, 1.0 / 24);
  options.scheme = scheme;
  options.kinematics = options::KinematicsOption::finite;
  return options;
}
} // namespace

TEST(Newton, ResidualsFallQuadratically)
{
  const test::Option tight("-ksp_rtol", "1e-12");
  const test::Option deep("-snes_rtol", "1e-13");
  for (const auto scheme : {couple::Scheme::energy, couple::Scheme::ghost, couple::Scheme::interface})
    for (const bool assembled : {false, true}) {
      test::Scene scene(stretched_plate(scheme), assembled);
      scene.solve();
      const std::vector<double>& norms = scene.report().norms.at(0);
      puts("");
      ASSERT_GE(norms.size(), 4u);
      EXPECT_LE(norms.size(), 8u);
      // Once the residual is small, r' <= C r^2 / r_0 until round-off.
      for (std::size_t k = 1; k + 1 < norms.size(); ++k) {
        const double here = norms[k] / norms[0], next = norms[k + 1] / norms[0];
        if (here < 1e-2) {
          EXPECT_LE(next, std::max(10.0 * here * here, 1e-12)) << k;
        }
      }
    }
}

TEST(Newton, LoadStepsReachTheSameState)
{
  test::Scene scene(stretched_plate(couple::Scheme::energy));
  const VecHandle once = scene.solve(), steps = scene.solve(4);
  EXPECT_EQ(scene.report().steps, 4);
  EXPECT_EQ(scene.report().norms.size(), 4u);
  PDX_CALL(VecAXPY(once.get(), -1.0, steps.get()));
  double gap = 0.0;
  PDX_CALL(VecNorm(once.get(), NORM_INFINITY, &gap));
  EXPECT_LT(gap, 1e-8);
}

TEST(Newton, LinearScenesNeedOneIterationAndOneTangentForAllSteps)
{
  auto options = stretched_plate(couple::Scheme::energy);
  options.kinematics = options::KinematicsOption::small;
  test::Scene scene(options);
  scene.solve(3);
  EXPECT_EQ(scene.report().newton_iterations, 3);
  EXPECT_EQ(scene.report().jacobian_assemblies, 1);
  EXPECT_EQ(scene.report().preconditioner_builds, 1);
}
