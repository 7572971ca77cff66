#include "support/uniform_strain.hpp"

#include <gtest/gtest.h>

namespace pdx::test::patch_test {
using couple::Scheme;

namespace {
const geom::Box<2> kMiddle{{0.25, 0.25}, {0.75, 0.75}};
constexpr double kExact = 1e-10; // relative, all rows

options::SceneOptions plate(Index cells = 16) { return test::held_plate({cells, cells}); }
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
  options.pd.surface_correction = options::SurfaceCorrection::volume;
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
} // namespace pdx::test::patch_test
