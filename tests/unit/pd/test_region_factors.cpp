#include "pdx/pd/region_factors.hpp"

#include <gtest/gtest.h>
#include <limits>

using namespace pdx;

namespace {
law::Elastic solid(double young)
{
  law::Elastic elastic;
  elastic.young = young;
  elastic.poisson = 1.0 / 3.0;
  elastic.density = 1000.0;
  return elastic;
}
} // namespace

// Sites 0 to 9 and 0 to 3, one apart from (.5, .5) on; what lies right of x = 6 is three times as stiff.
TEST(RegionFactors, AreHalvesInARowAcrossTheBorder)
{
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto regions = std::make_shared<const law::Regions>(
      solid(1.0), kNever, 1.0,
      std::vector<law::Region>{
          {"right", geom::Outline(geom::Outline::edges_of({{6.0, -5.0}, {20.0, 9.0}})), solid(3.0), kNever}},
      std::span<const law::Interface>());
  const pd::Stencil<2> stencil =
      pd::make_stencil<2>({1.0, 1.0, 3.0, law::Micromodulus::conical, pd::Calibration::lattice, solid(1.0)});
  ASSERT_EQ(stencil.reach, 2);
  const pd::WindowSites<2> window{{{0.0, 0.0}, 1.0, {10, 4}}, {0, 0}, {10, 4}};
  const pd::BondFactors<2> factors = pd::correct_regions<2>(stencil, regions, {})(window);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x)
      for (std::size_t arm = 0; arm < stencil.half.size(); ++arm) {
        const int end = x + stencil.half[arm].step[0];
        const int stiff = (x >= 6) + (end >= 6);
        EXPECT_DOUBLE_EQ(factors.of({x, y}, arm), stiff == 0 ? 1.0 : stiff == 1 ? 1.5 : 3.0) << x << ' ' << arm;
      }
  EXPECT_FALSE(factors.any({3, 1}));
  EXPECT_TRUE(factors.any({4, 1})); // bonds of two spacings reach site 6
  EXPECT_EQ(factors.end_of_plain({0, 1}), 4);
  EXPECT_EQ(factors.end_of_plain({5, 1}), 5);
}
