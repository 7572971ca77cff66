#include "pdx/track/crack_growth.hpp"
#include "support/bare_patch.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace pdx;

namespace {
// Bonds to the 8 nearest sites; along y = 4 upright ones cross at 0.5, 1.5, ..., slanted ones at 1, 2, ...
const geom::Lattice<2> kLattice{{0.0, 0.0}, 1.0, {16, 8}};
const geom::Box<2> kBody{{0.0, 0.0}, {16.0, 8.0}};

int owner(Index site)
{
  int n = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &n);
  return (site % 16 / 3 + site / 16) % n;
}

crack::CrackSet one_crack(const Vector<2>& from, const Vector<2>& to) { return crack::CrackSet({{from, to}}, kBody); }

std::vector<track::TipGrowth> growth(const crack::CrackSet& given, const crack::CrackSet& grown)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 2.0, owner);
  patch.parts[0]->cut(grown);
  return track::crack_growth(patch.comm, patch.parts, given);
}
} // namespace

TEST(CrackGrowth, OfACrackThatStaysIsNone)
{
  const auto given = one_crack({0.0, 4.0}, {4.25, 4.0});
  const auto found = growth(given, given);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].first_intact, 0.25, 1e-12);
  EXPECT_EQ(found[0].farthest_broken, 0.0);
}

TEST(CrackGrowth, BondsThatMeetTheTipAreIntactThere)
{
  const auto given = one_crack({0.0, 4.0}, {4.5, 4.0});
  EXPECT_EQ(growth(given, given)[0].first_intact, 0.0);
}

TEST(CrackGrowth, LiesBetweenTheNearestIntactAndTheFarthestBrokenCrossing)
{
  const auto found = growth(one_crack({0.0, 4.0}, {4.25, 4.0}), one_crack({0.0, 4.0}, {7.25, 4.0}));
  EXPECT_NEAR(found[0].first_intact, 7.5 - 4.25, 1e-6);
  EXPECT_NEAR(found[0].farthest_broken, 7.0 - 4.25, 1e-6);
}

TEST(CrackGrowth, OfFacingTipsIsEachItsOwn)
{
  const crack::CrackSet given({{{0.0, 4.0}, {4.25, 4.0}}, {{11.25, 4.0}, {16.0, 4.0}}}, kBody);
  const crack::CrackSet grown({{{0.0, 4.0}, {5.25, 4.0}}, {{9.25, 4.0}, {16.0, 4.0}}}, kBody);
  const auto found = growth(given, grown);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].farthest_broken, 5.0 - 4.25, 1e-6);
  EXPECT_NEAR(found[1].farthest_broken, 11.25 - 9.5, 1e-6);
  EXPECT_NEAR(found[0].first_intact, 5.5 - 4.25, 1e-6);
  EXPECT_NEAR(found[1].first_intact, 11.25 - 9.0, 1e-6);
}

TEST(CrackGrowth, IsTakenAtBothTipsOfAnInnerCrack)
{
  const auto given = one_crack({6.25, 4.0}, {8.75, 4.0}), grown = one_crack({3.25, 4.0}, {10.75, 4.0});
  for (const track::TipGrowth& found : growth(given, grown)) {
    const bool last = given.tips()[found.tip].last;
    EXPECT_NEAR(found.first_intact, last ? 11.0 - 8.75 : 6.25 - 3.0, 1e-6);
    EXPECT_NEAR(found.farthest_broken, last ? 10.5 - 8.75 : 6.25 - 3.5, 1e-6);
  }
  EXPECT_EQ(growth(given, grown).size(), 2u);
}

TEST(CrackGrowth, BrokenBondsBehindTheTipOrBesideItDoNotCount)
{
  const auto given = one_crack({0.0, 4.0}, {4.25, 4.0});
  const crack::CrackSet more({{{0.0, 4.0}, {4.25, 4.0}}, {{0.0, 6.0}, {12.0, 6.0}}, {{2.0, 5.0}, {2.0, 0.0}}}, kBody);
  const auto found = growth(given, more);
  EXPECT_NEAR(found[0].first_intact, 0.25, 1e-12);
  EXPECT_EQ(found[0].farthest_broken, 0.0);
}

TEST(CrackGrowth, OfAPatchTornInTwoMeetsNoIntactBond)
{
  const auto found = growth(one_crack({0.0, 4.0}, {4.25, 4.0}), one_crack({0.0, 4.0}, {16.0, 4.0}));
  EXPECT_EQ(found[0].first_intact, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(found[0].farthest_broken, 15.5 - 4.25, 1e-6);
}

TEST(CrackGrowth, TipsOutsideOfPatchesAreLeftOut)
{
  const crack::CrackSet far({{{20.0, 4.0}, {24.0, 4.0}}}, geom::Box<2>{{0.0, 0.0}, {30.0, 8.0}});
  EXPECT_TRUE(growth(far, far).empty());
}

namespace {
const geom::Lattice<2> kWide{{0.0, 0.0}, 1.0, {80, 60}};
const geom::Box<2> kPlate{{0.0, 0.0}, {80.0, 60.0}};

std::vector<track::TipGrowth> wide_growth(const std::vector<crack::Polyline>& given,
                                          const std::vector<crack::Polyline>& grown)
{
  const auto spread = [](Index site) {
    int n = 1;
    MPI_Comm_size(PETSC_COMM_WORLD, &n);
    return (site % 80 / 7 + site / 800) % n;
  };
  const test::BarePatch patch(PETSC_COMM_WORLD, kWide, 3.0, spread);
  patch.parts[0]->cut(crack::CrackSet(grown, kPlate));
  return track::crack_growth(patch.comm, patch.parts, crack::CrackSet(given, kPlate));
}

double away(const crack::Polyline& line, const Vector<2>& x)
{
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vector<2> way = line[k + 1] - line[k];
    const double t = std::clamp((x - line[k]).dot(way) / way.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (line[k] + t * way - x).norm());
  }
  return nearest;
}
} // namespace

// Measured: within .2 spacings of the crack (half a spacing at the kink), tips to .3, lengths to .4.
TEST(CrackGrowth, GoesWhereTheCrackTurns)
{
  for (const double degrees : {-55.0, -20.0, 15.0, 40.0, 70.0}) {
    const double angle = degrees * 3.14159265358979 / 180.0;
    const Vector<2> tip(16.25, 30.3), end = tip + 26.3 * Vector<2>(std::cos(angle), std::sin(angle));
    const crack::Polyline given{{0.0, 30.3}, tip}, grown{{0.0, 30.3}, tip, end};
    const auto found = wide_growth({given}, {grown});
    ASSERT_EQ(found.size(), 1u);
    const crack::Polyline& path = found[0].path;
    ASSERT_GT(path.size(), 3u);
    EXPECT_EQ(path.front(), tip);
    EXPECT_LT((path.back() - end).norm(), 0.7) << degrees;
    EXPECT_NEAR(track::length(path), 26.3, 0.7) << degrees;
    for (const Vector<2>& x : path) EXPECT_LT(away(grown, x), 0.6) << degrees;
    EXPECT_NEAR(found[0].first_intact, 26.3, 1.5);
    EXPECT_NEAR(found[0].farthest_broken, 26.3, 1.5);
    EXPECT_LE(found[0].first_intact, found[0].farthest_broken + 1.0);
  }
}

TEST(CrackGrowth, OfTipsThatRanIntoEachOtherIsCountedOnce)
{
  const std::vector<crack::Polyline> given{{{0.0, 20.3}, {16.25, 20.3}}, {{80.0, 40.3}, {63.25, 40.3}}};
  const std::vector<crack::Polyline> grown{{{0.0, 20.3}, {16.25, 20.3}, {63.25, 40.3}, {80.0, 40.3}}};
  const auto found = wide_growth(given, grown);
  ASSERT_EQ(found.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    ASSERT_TRUE(found[k].met);
    EXPECT_EQ(*found[k].met, 1 - k);
    EXPECT_NEAR(track::length(found[k].path), std::hypot(47.0, 20.0), 1.0);
  }
}

TEST(CrackGrowth, EndsAtAnotherCrackAndAtTheFlankOfOneThatGrew)
{
  const crack::Polyline up{{40.2, 0.0}, {40.2, 12.0}}, flank{{40.2, 0.0}, {40.2, 50.0}};
  const crack::Polyline along{{0.0, 30.3}, {16.25, 30.3}}, into{{0.0, 30.3}, {16.25, 30.3}, {40.2, 34.0}};
  const auto found = wide_growth({up, along}, {flank, into});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(track::length(found[0].path), 38.0, 0.7);
  EXPECT_NEAR(found[1].path.back().x(), 40.2, 0.7);
  EXPECT_NEAR(found[1].path.back().y(), 34.0, 0.7);
  const auto known = wide_growth({flank, along}, {flank, into});
  EXPECT_NEAR(known[1].path.back().x(), 40.2, 0.7);
}

TEST(PathOfACrack, IsWalkedByDistance)
{
  const crack::Polyline path{{0.0, 0.0}, {3.0, 0.0}, {3.0, 4.0}};
  EXPECT_EQ(track::length(path), 7.0);
  EXPECT_EQ(track::place_on(path, {0.0, 1.0}, 5.0), Vector<2>(3.0, 2.0));
  EXPECT_EQ(track::place_on(path, {0.0, 1.0}, 9.0), Vector<2>(3.0, 6.0));
  EXPECT_EQ(track::path_up_to(path, 5.0), (crack::Polyline{{0.0, 0.0}, {3.0, 0.0}, {3.0, 2.0}}));
  EXPECT_EQ(track::path_up_to(path, 0.0).size(), 1u);
}
