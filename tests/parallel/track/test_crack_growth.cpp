#include "pdx/track/crack_growth.hpp"
#include "support/bare_patch.hpp"

#include <gtest/gtest.h>

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
  patch.cut(grown);
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
  EXPECT_NEAR(found[0].first_intact, 7.5 - 4.25, 1e-12);
  EXPECT_NEAR(found[0].farthest_broken, 7.0 - 4.25, 1e-12);
}

TEST(CrackGrowth, OfFacingTipsIsEachItsOwn)
{
  const crack::CrackSet given({{{0.0, 4.0}, {4.25, 4.0}}, {{11.25, 4.0}, {16.0, 4.0}}}, kBody);
  const crack::CrackSet grown({{{0.0, 4.0}, {5.25, 4.0}}, {{9.25, 4.0}, {16.0, 4.0}}}, kBody);
  const auto found = growth(given, grown);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].farthest_broken, 5.0 - 4.25, 1e-12);
  EXPECT_NEAR(found[1].farthest_broken, 11.25 - 9.5, 1e-12);
  EXPECT_NEAR(found[0].first_intact, 5.5 - 4.25, 1e-12);
  EXPECT_NEAR(found[1].first_intact, 11.25 - 9.0, 1e-12);
}

TEST(CrackGrowth, IsTakenAtBothTipsOfAnInnerCrack)
{
  const auto given = one_crack({6.25, 4.0}, {8.75, 4.0}), grown = one_crack({3.25, 4.0}, {10.75, 4.0});
  for (const track::TipGrowth& found : growth(given, grown)) {
    const bool last = given.tips()[found.tip].last;
    EXPECT_NEAR(found.first_intact, last ? 11.0 - 8.75 : 6.25 - 3.0, 1e-12);
    EXPECT_NEAR(found.farthest_broken, last ? 10.5 - 8.75 : 6.25 - 3.5, 1e-12);
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
  EXPECT_NEAR(found[0].farthest_broken, 15.5 - 4.25, 1e-12);
}

TEST(CrackGrowth, TipsOutsideOfPatchesAreLeftOut)
{
  const crack::CrackSet far({{{20.0, 4.0}, {24.0, 4.0}}}, geom::Box<2>{{0.0, 0.0}, {30.0, 8.0}});
  EXPECT_TRUE(growth(far, far).empty());
}
