#include "support/manufactured.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
struct Choice {
  const char* name;
  law::Micromodulus micromodulus;
  double ratio;
};

/// Error in L2 of n x n particles under the solid's body force, held to the solid's displacement in layers.
double error_of(Index n, const Choice& choice)
{
  auto options = test::held_particles(n);
  options.pd.surface_correction = options::SurfaceCorrection::none; // the layers go on beyond what is modelled
  options.pd.micromodulus = choice.micromodulus;
  options.pd.horizon_ratio = choice.ratio;
  test::Scene scene(options);
  const test::Manufactured solid{options.elastic};
  scene.load([&](const Vector<2>& x) { return solid.body_force(x); });
  scene.prescribe(test::Manufactured::displacement);
  return scene.l2_error(scene.solve().get(), test::Manufactured::displacement);
}
} // namespace

// Horizon and spacing shrink together: the particles tend to the local solid, with half the horizon a quarter the
// error.
TEST(DeltaConvergence, IsOfSecondOrderForSmoothDisplacements)
{
  for (const Choice& choice : {Choice{"conical, horizon 4 dx", law::Micromodulus::conical, 4.0},
                               Choice{"uniform, horizon 3 dx", law::Micromodulus::uniform, 3.0}}) {
    double coarse = error_of(10, choice);
    EXPECT_GT(coarse, 1e-3);
    for (const Index n : {20, 40, 80}) {
      const double fine = error_of(n, choice), order = std::log2(coarse / fine);
      EXPECT_GE(order, 2.0) << choice.name << ", " << n << " a side";
      EXPECT_LE(order, 2.4) << choice.name << ", " << n << " a side";
      coarse = fine;
    }
  }
}

TEST(DeltaConvergence, UniformStrainIsExactWithCalibratedBonds)
{
  const test::Option tight("-ksp_rtol", "1e-13");
  auto options = test::held_particles(20);
  options.pd.surface_correction = options::SurfaceCorrection::none;
  test::Scene scene(options);
  const auto field = test::affine(1e-3, 7e-4, 2e-4, -8e-4, {3e-4, -2e-4});
  scene.prescribe(field);
  EXPECT_LT(scene.max_error(scene.solve().get(), field), 1e-12);
}
