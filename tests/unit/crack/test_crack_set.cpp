#include "pdx/base/error.hpp"
#include "pdx/crack/crack_set.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace pdx::test::crack_set {
namespace {
using crack::CrackSet;
using crack::Polyline;
const geom::Box<2> kBody{{0.0, 0.0}, {4.0, 2.0}};

TEST(CrackSet, LeftIsPlus)
{
  const CrackSet cracks({{{1, 1}, {3, 1}}}, kBody);
  EXPECT_EQ(cracks.side(0, {2, 1.5}), 1);
  EXPECT_EQ(cracks.side(0, {2, 0.5}), -1);
  EXPECT_DOUBLE_EQ(cracks.signed_distance(0, {2, 1.25}), 0.25);
  EXPECT_DOUBLE_EQ(cracks.signed_distance(0, {2, 0.5}), -0.5);
  const CrackSet reversed({{{3, 1}, {1, 1}}}, kBody);
  EXPECT_EQ(reversed.side(0, {2, 1.5}), -1);
}

TEST(CrackSet, PointsOnTheCrackAreLeftWhicheverWayItRuns)
{
  for (const Polyline& line : {Polyline{{1, 1}, {3, 1}}, Polyline{{3, 1}, {1, 1}}}) {
    const CrackSet cracks({line}, kBody);
    for (const double x : {0.0, 1.0, 1.3, 2.0, 3.0, 3.9}) // prolongation and tips included
      EXPECT_EQ(cracks.side(0, {x, 1.0}), 1) << x;
  }
  const Polyline bent{{1, 1}, {2, 1}, {3, 2}, {4, 1}}; // left turn, then right turn
  const CrackSet cracks({bent}, geom::Box<2>{{0, 0}, {9, 9}});
  for (const Vector<2>& corner : bent) EXPECT_EQ(cracks.side(0, corner), 1);
  EXPECT_EQ(cracks.side(0, {2.5, 1.5}), 1);
}

TEST(CrackSet, BeyondATipItGoesOnStraight)
{
  const CrackSet cracks({{{1, 1}, {3, 1}}}, kBody);
  EXPECT_DOUBLE_EQ(cracks.signed_distance(0, {3.5, 1.2}), 0.2);
  EXPECT_DOUBLE_EQ(cracks.signed_distance(0, {0.5, 0.8}), -0.2);
  EXPECT_DOUBLE_EQ(cracks.beyond(0, {3.5, 1.2}), 0.5);
  EXPECT_DOUBLE_EQ(cracks.beyond(0, {0.75, 1.2}), 0.25);
  EXPECT_EQ(cracks.beyond(0, {2.0, 1.2}), 0.0);
}

// A roof: up to (2, 2), down again. Above it is left. Round its apex, the sides follow the wedge.
TEST(CrackSet, KnowsTheSidesOfACorner)
{
  const CrackSet roof({{{1, 0}, {2, 2}, {3, 0}}}, geom::Box<2>{{-9, -9}, {9, 9}});
  EXPECT_EQ(roof.side(0, {2, 2.1}), 1);
  EXPECT_EQ(roof.side(0, {2, 1.9}), -1);
  EXPECT_EQ(roof.side(0, {2.1, 2.2}), 1); // ahead of the first piece, beside its line on either side
  EXPECT_EQ(roof.side(0, {2.2, 2.2}), 1);
  EXPECT_NEAR(roof.signed_distance(0, {2, 2.5}), 0.5, 1e-15);
  EXPECT_NEAR(roof.signed_distance(0, {2, 1.0}), -1.0 / std::sqrt(5.0), 1e-15);
  const CrackSet valley({{{1, 2}, {2, 0}, {3, 2}}}, geom::Box<2>{{-9, -9}, {9, 9}});
  EXPECT_EQ(valley.side(0, {2, -0.1}), -1);
  EXPECT_EQ(valley.side(0, {2.1, -0.2}), -1);
  EXPECT_EQ(valley.side(0, {2, 0.1}), 1);
}

TEST(CrackSet, TipsAreTheEndsInsideTheBody)
{
  const CrackSet cracks({{{0, 1}, {1, 1}, {2, 1.5}}, {{1, 0.5}, {3, 0.5}}, {{3, 0}, {3.5, 3}}}, kBody);
  ASSERT_EQ(cracks.tips().size(), 3u);
  EXPECT_EQ(cracks.tips()[0].crack, 0);
  EXPECT_TRUE(cracks.tips()[0].last);
  EXPECT_EQ(cracks.tips()[0].at, Vector<2>(2, 1.5));
  EXPECT_NEAR((cracks.tips()[0].direction - Vector<2>(2, 1) / std::sqrt(5.0)).norm(), 0.0, 1e-15);
  EXPECT_FALSE(cracks.tips()[1].last);
  EXPECT_EQ(cracks.tips()[1].direction, Vector<2>(-1, 0));
  EXPECT_TRUE(cracks.tips()[2].last);
  EXPECT_NEAR(cracks.length(0), 1.0 + std::sqrt(1.25), 1e-15);
}

TEST(CrackSet, AMouthLeavesNoSkin)
{
  // Rounding has left the crack's mouth short of the surface by a part of 1e-12.
  const CrackSet cracks({{{4e-12, 1}, {2, 1}}}, kBody);
  EXPECT_EQ(cracks.tips().size(), 1u);
  EXPECT_TRUE(cracks.cuts({0.0, 0.9}, {0.0, 1.1}));
  const CrackSet inner({{{0.01, 1}, {2, 1}}}, kBody);
  EXPECT_EQ(inner.tips().size(), 2u);
  EXPECT_FALSE(inner.cuts({0.0, 0.9}, {0.0, 1.1}));
}

TEST(CrackSet, TakesAnyBody)
{
  const auto disc = [](const Vector<2>& x) { return x.norm() < 1.0; };
  const CrackSet cracks({{{-1, 0}, {0.5, 0}}}, disc, 0.1);
  EXPECT_EQ(cracks.tips().size(), 1u);
  EXPECT_TRUE(cracks.cuts({-1.05, -0.1}, {-1.05, 0.1}));
  EXPECT_FALSE(cracks.cuts({-1.15, -0.1}, {-1.15, 0.1}));
  EXPECT_EQ(cracks.points(0).size(), 2u);
}

std::string refusal(const Polyline& points)
{
  try {
    const CrackSet cracks({{{0, 0}, {1, 1}}, points}, kBody);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(CrackSet, RefusesWhatIsNoCrack)
{
  EXPECT_EQ(refusal({{1, 1}}), "crack 2: 1 point(s) given; a crack needs two or more");
  EXPECT_EQ(refusal({}), "crack 2: 0 point(s) given; a crack needs two or more");
  EXPECT_NE(refusal({{1, 1}, {1, 1}, {2, 2}}).find("(1, 1) is there twice"), std::string::npos);
  EXPECT_NE(refusal({{1, 1}, {2, 1}, {1.5, 1}}).find("turns back on itself at (2, 1)"), std::string::npos);
  EXPECT_NE(refusal({{1, 1}, {2, 1}, {2, 2}, {1.5, 0}}).find("meet"), std::string::npos);
  EXPECT_NE(refusal({{1, 1}, {std::nan(""), 2}}).find("finite"), std::string::npos);
  EXPECT_EQ(refusal({{1, 1}, {2, 1}, {1.5, 1.001}}), ""); // sharp, but a corner
}
} // namespace
} // namespace pdx::test::crack_set
