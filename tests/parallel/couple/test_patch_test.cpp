#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using couple::Scheme;

namespace {
const geom::Box<2> kMiddle{{0.25, 0.25}, {0.75, 0.75}};
constexpr double kExact = 1e-10; // relative, all rows

struct Strain {
  const char* name;
  test::Field field;
};
const Strain kStrains[] = {{"e_xx", test::affine(1e-3, 0.0, 0.0, 0.0)},
                           {"e_yy", test::affine(0.0, 0.0, 0.0, 1e-3)},
                           {"gamma_xy", test::affine(0.0, 5e-4, 5e-4, 0.0)},
                           {"all", test::affine(1e-3, 7e-4, 2e-4, -8e-4, {3e-4, -2e-4})}};

/// Largest error of a uniform strain imposed on the outer boundary, over the four strains.
double worst_error(const app::SceneOptions& options)
{
  const test::Option tight("-ksp_rtol", "1e-13");
  test::Scene scene(options);
  double worst = 0.0;
  for (const Strain& strain : kStrains) {
    scene.prescribe(strain.field);
    worst = std::max(worst, scene.max_error(scene.solve().get(), strain.field));
  }
  return worst;
}

app::SceneOptions plate(Index cells = 16) { return test::held_plate({cells, cells}); }
} // namespace

TEST(PatchTest, EnergySchemeWithAnAlignedPatchInTheMiddle)
{
  EXPECT_LE(worst_error(test::with_patch(plate(), kMiddle, 1.0 / 32)), kExact);
}

TEST(PatchTest, EnergySchemeWithAPatchOffTheCentre)
{
  EXPECT_LE(worst_error(test::with_patch(plate(), {{0.125, 0.4375}, {0.5, 0.875}}, 1.0 / 48)), kExact);
}

TEST(PatchTest, EnergySchemeWithTwoPatchesOfDifferentSpacing)
{
  const auto one = test::with_patch(plate(), {{0.125, 0.25}, {0.4375, 0.75}}, 1.0 / 32);
  EXPECT_LE(worst_error(test::with_patch(one, {{0.5, 0.125}, {0.875, 0.625}}, 1.0 / 64)), kExact);
}

TEST(PatchTest, EnergySchemeWithAPatchNarrowerThanAHorizon)
{
  EXPECT_LE(worst_error(test::with_patch(plate(), {{0.25, 0.5}, {0.75, 0.5625}}, 1.0 / 32)), kExact);
}

TEST(PatchTest, EnergySchemeInPlaneStrain)
{
  auto options = test::with_patch(plate(), kMiddle, 1.0 / 32);
  options.elastic.plane = law::Plane::strain;
  options.elastic.poisson = 0.25;
  EXPECT_LE(worst_error(options), kExact);
}

TEST(PatchTest, EnergySchemeWithUniformMicromodulusAndThreeSpacings)
{
  auto options = test::with_patch(plate(), kMiddle, 1.0 / 32);
  options.pd.micromodulus = law::Micromodulus::uniform;
  options.pd.horizon_ratio = 3.0;
  EXPECT_LE(worst_error(options), kExact);
}

TEST(PatchTest, EnergySchemeOnCellsThatAreNotSquare)
{
  EXPECT_LE(worst_error(test::with_patch(test::held_plate({16, 8}), kMiddle, 1.0 / 32)), kExact);
}

// The patch ends 0.0625 from the plate's edges, its bonds reach 4/48: what lies behind elements counts to its bonds.
TEST(PatchTest, EnergySchemeWithAPatchNearerToTheEdgeThanAHorizon)
{
  EXPECT_LE(worst_error(test::with_patch(plate(), {{0.0625, 0.4375}, {0.5, 0.9375}}, 1.0 / 48)), kExact);
}

// Lattice cells that straddle two elements: the trace is averaged over the cell, and forces still add up exactly.
TEST(PatchTest, EnergySchemeWithElementsOfABrokenNumberOfSpacings)
{
  EXPECT_LE(worst_error(test::with_patch(plate(), kMiddle, 1.0 / 40)), kExact); // h = 2.5 dx
  EXPECT_LE(worst_error(test::with_patch(plate(), kMiddle, 1.0 / 72)), kExact); // h = 4.5 dx
  EXPECT_LE(worst_error(test::with_patch(plate(), kMiddle, 0.5 / 11)), kExact); // h = 1.375 dx
  EXPECT_LE(worst_error(test::with_patch(plate(), {{0.0625, 0.4375}, {0.4375, 0.8125}}, 0.375 / 17)), kExact);
}

TEST(PatchTest, InterfaceSchemeWithElementsOfABrokenNumberOfSpacings)
{
  auto options = test::with_patch(plate(), kMiddle, 1.0 / 40);
  options.scheme = Scheme::interface;
  EXPECT_LE(worst_error(options), kExact);
}

TEST(PatchTest, InterfaceSchemePassesWithItsClippedCorners)
{
  auto options = test::with_patch(plate(), kMiddle, 1.0 / 32);
  options.scheme = Scheme::interface;
  EXPECT_LE(worst_error(options), kExact);
}

TEST(PatchTest, BondsOfTheContinuumFailByTheirModuli)
{
  auto options = test::with_patch(plate(), kMiddle, 1.0 / 32);
  options.pd.calibration = pd::Calibration::continuum;
  EXPECT_GT(worst_error(options), 1e-3);
}

namespace {
/// Pulled along x between held ends; bottom and perhaps top are free.
app::SceneOptions bar(bool free_top)
{
  auto options = plate();
  std::erase_if(options.conditions, [&](const auto& c) { return c.on == "bottom" || (free_top && c.on == "top"); });
  return options;
}
double tension_error(const app::SceneOptions& options)
{
  const test::Option tight("-ksp_rtol", "1e-13");
  const test::Field tension = test::affine(1e-3, 0.0, 0.0, -1e-3 / 3.0, {2e-4, 1e-4});
  test::Scene scene(options);
  scene.prescribe(tension);
  return scene.max_error(scene.solve().get(), tension);
}
const geom::Box<2> kAtTheBottom{{0.25, 0.0}, {0.75, 0.5}}, kFromBottomToTop{{0.25, 0.0}, {0.75, 1.0}};
} // namespace

// Elements of 1, 2, 2.5, 4.5 and 5 spacings.
TEST(PatchTest, APatchAtAFreeSideIsExactInTensionAlongIt)
{
  for (const double spacings : {1.0, 2.0, 2.5, 4.5, 5.0}) {
    EXPECT_LE(tension_error(test::with_patch(bar(false), kAtTheBottom, 0.0625 / spacings)), kExact) << spacings;
    EXPECT_LE(tension_error(test::with_patch(bar(true), kFromBottomToTop, 0.0625 / spacings)), kExact) << spacings;
  }
}

TEST(PatchTest, AFreeSideIsExactWithOtherBonds)
{
  for (const double ratio : {3.0, 6.0})
    for (const auto micromodulus : {law::Micromodulus::conical, law::Micromodulus::uniform}) {
      auto options = test::with_patch(bar(false), kAtTheBottom, 1.0 / 48);
      options.pd.horizon_ratio = ratio;
      options.pd.micromodulus = micromodulus;
      EXPECT_LE(tension_error(options), kExact) << ratio;
    }
}

TEST(PatchTest, TheVolumeMethodFailsAtAFreeSide)
{
  auto options = test::with_patch(bar(false), kAtTheBottom, 1.0 / 48);
  options.pd.surface_correction = app::SurfaceCorrection::volume;
  EXPECT_GT(tension_error(options), 1e-3);
}

// The geometry of [XPD1 Sec. 3.2]: the papers' scheme fails by 0.32 %.
TEST(PatchTest, GhostSchemeFailsByAThirdOfAPercent)
{
  auto options = test::with_patch(plate(100), {{0.3, 0.3}, {0.7, 0.7}}, 1.0 / 200);
  options.scheme = Scheme::ghost;
  test::Scene scene(options);
  for (const int k : {0, 2}) {
    scene.prescribe(kStrains[k].field);
    EXPECT_NEAR(100.0 * scene.max_error(scene.solve().get(), kStrains[k].field), 0.31, 0.02) << kStrains[k].name;
  }
}
