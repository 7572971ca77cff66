#include "pdx/geom/site_names.hpp"

#include <gtest/gtest.h>
#include <set>

using namespace pdx;

TEST(SiteNames, ArePartedByLatticeAndLeadBackToTheSite)
{
  const geom::SiteNames coarse{{64, 70}, 500, 0, 2}, fine{{90, 64}, 900, 1, 2};
  std::set<std::uint64_t> seen;
  for (const geom::SiteNames* names : {&coarse, &fine})
    for (Index y = -3; y < 40; y += 7)
      for (Index x = -5; x < 60; x += 3) {
        const std::uint64_t name = names->of({x, y});
        EXPECT_TRUE(seen.insert(name).second);
        ASSERT_TRUE(names->site(name));
        EXPECT_EQ(*names->site(name), (Site<2>{x, y}));
        EXPECT_FALSE((names == &coarse ? fine : coarse).site(name));
      }
}

TEST(SiteNames, OfOnePlaceAreTheSameFromTwoPieces)
{
  const geom::SiteNames left{{64, 64}, 500, 0, 1}, right{{84, 74}, 500, 0, 1};
  EXPECT_EQ(left.of({25, 12}), right.of({5, 2}));
  EXPECT_EQ(*right.site(left.of({0, 0})), (Site<2>{-20, -10}));
}

TEST(SiteNames, FarAwayAreNoSite) { EXPECT_FALSE(geom::SiteNames{}.site(1ULL << 62)); }
