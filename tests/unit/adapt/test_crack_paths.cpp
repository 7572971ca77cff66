#include "pdx/adapt/crack_paths.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using crack::Polyline;

TEST(CrackPaths, GoOnFromTheirLastPoint)
{
  const Polyline ahead{{2.0, 0.0}, {3.0, 0.0}, {4.0, 1.0}};
  EXPECT_EQ(adapt::gone_on({{0.0, 0.0}, {1.0, 0.0}}, true, ahead),
            (Polyline{{0.0, 0.0}, {1.0, 0.0}, {3.0, 0.0}, {4.0, 1.0}}));
}

TEST(CrackPaths, GoOnFromTheirFirstPointInTheOrderInWhichTheyRun)
{
  const Polyline ahead{{0.0, 0.0}, {-1.0, 0.0}, {-2.0, 1.0}};
  EXPECT_EQ(adapt::gone_on({{0.0, 0.0}, {1.0, 0.0}}, false, ahead),
            (Polyline{{-2.0, 1.0}, {-1.0, 0.0}, {0.0, 0.0}, {1.0, 0.0}}));
}

TEST(CrackPaths, NothingAheadChangesNothing)
{
  const Polyline crack{{0.0, 0.0}, {1.0, 2.0}};
  EXPECT_EQ(adapt::gone_on(crack, true, {}), crack);
  EXPECT_EQ(adapt::gone_on(crack, false, {}), crack);
}

TEST(CrackPaths, DistancesAreThoseToTheNearestPlace)
{
  const std::vector<Polyline> chains{{{0.0, 0.0}, {2.0, 0.0}}, {{0.0, 5.0}, {0.0, 7.0}}};
  EXPECT_DOUBLE_EQ(adapt::distance(chains, {1.0, -3.0}), 3.0);
  EXPECT_DOUBLE_EQ(adapt::distance(chains, {5.0, 4.0}), 5.0);
  EXPECT_DOUBLE_EQ(adapt::distance(chains, {-0.5, 6.0}), 0.5);
  const geom::Box<2> box{{0.0, 0.0}, {1.0, 1.0}};
  EXPECT_EQ(adapt::distance(box, {0.5, 0.5}), 0.0);
  EXPECT_DOUBLE_EQ(adapt::distance(box, {4.0, 5.0}), 5.0);
}
