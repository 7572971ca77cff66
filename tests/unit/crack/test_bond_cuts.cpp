#include "pdx/base/error.hpp"
#include "pdx/crack/crack_set.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace {
using namespace pdx;
using crack::CrackSet;
using crack::Polyline;
const geom::Box<2> kBody{{-100.0, -100.0}, {100.0, 100.0}};

/// One way and the other, which must agree.
bool cuts(const CrackSet& cracks, const Vector<2>& a, const Vector<2>& b)
{
  EXPECT_EQ(cracks.cuts(a, b), cracks.cuts(b, a));
  return cracks.cuts(a, b);
}
double after(double x) { return std::nextafter(x, 1e9); }

TEST(BondCuts, CrossingIsCutBesideStays)
{
  const CrackSet cracks({{{1, 1}, {3, 1}}}, kBody);
  EXPECT_TRUE(cuts(cracks, {2, 0}, {2.5, 2}));
  EXPECT_FALSE(cuts(cracks, {2, 0}, {2.5, 0.9}));
  EXPECT_FALSE(cuts(cracks, {3.5, 0}, {3.5, 2}));
  EXPECT_FALSE(cuts(cracks, {2, 1.1}, {2.5, 2}));
}

TEST(BondCuts, AnEndOnAnotherCrackIsAJunction)
{
  // The sides of a square, each a crack of its own, two of them seen from the other end; and a T within a piece.
  const CrackSet square({{{1, 1}, {3, 1}}, {{3, 3}, {3, 1}}, {{3, 3}, {1, 3}}, {{1, 1}, {1, 3}}}, kBody);
  EXPECT_TRUE(square.tips().empty());
  for (const Vector<2>& corner : {Vector<2>(1, 1), Vector<2>(3, 1), Vector<2>(3, 3), Vector<2>(1, 3)}) {
    const Vector<2> out = corner - Vector<2>(2, 2);
    EXPECT_TRUE(cuts(square, corner - 0.25 * out, corner + 0.25 * out));
    EXPECT_FALSE(cuts(square, corner + 0.25 * out, corner + 0.5 * out));
  }
  ASSERT_EQ(square.junctions().size(), 8u);
  EXPECT_EQ(square.junctions()[1].other, 1); // the first crack's last point
  const CrackSet tee({{{1, 1}, {3, 1}}, {{2, 1}, {2, 3}}}, kBody);
  ASSERT_EQ(tee.tips().size(), 3u); // both ends of the first, the far end of the second
  EXPECT_TRUE(cuts(tee, {1.5, 1.0625}, {2.5, 1.0625}));
  EXPECT_FALSE(cuts(tee, {1.5, 0.999}, {2.5, 0.999})); // beyond the other crack nothing is cut
}

TEST(BondCuts, CracksThatRunAlongEachOtherAreRefused)
{
  const Polyline line{{1, 1}, {3, 1}};
  for (const Polyline& other :
       {line, Polyline{{3, 1}, {1, 1}}, Polyline{{2, 1}, {5, 1}}, Polyline{{2, 3}, {2, 1}, {2.5, 1}}})
    EXPECT_THROW(CrackSet({line, other}, kBody), UserError);
  EXPECT_NO_THROW(CrackSet({line, {{3, 1}, {5, 1}}, {{2, 0}, {2, 3}}, {{1, 1.001}, {3, 1.001}}}, kBody));
}

TEST(BondCuts, MeetingOnlyTheTipStays)
{
  for (const Polyline& line : {Polyline{{1, 1}, {3, 1}}, Polyline{{3, 1}, {1, 1}}}) {
    const CrackSet cracks({line}, kBody);
    EXPECT_FALSE(cuts(cracks, {3, 0}, {3, 2}));
    EXPECT_FALSE(cuts(cracks, {2.5, 0.5}, {3.5, 1.5}));
    EXPECT_FALSE(cuts(cracks, {2, 1}, {4, 1}));                 // along the crack, over the tip
    EXPECT_FALSE(cuts(cracks, {3, 1}, {4, 0}));                 // ends at the tip
    EXPECT_FALSE(cuts(cracks, {3 - 1e-15, 0}, {3 - 1e-15, 2})); // rounding
    EXPECT_TRUE(cuts(cracks, {3 - 1e-9, 0}, {3 - 1e-9, 2}));
    EXPECT_FALSE(cuts(cracks, {after(3), 0}, {after(3), 2}));
  }
}

// A tip on the line of a bond, or on the bond itself, says nothing about the rest of the crack.
TEST(BondCuts, CrossingElsewhereIsCutWhereverTheTipIs)
{
  const Polyline hook{{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 1}}; // a tip at either end
  for (const Polyline& crack : {hook, Polyline(hook.rbegin(), hook.rend())}) {
    const CrackSet cracks({crack}, kBody);
    EXPECT_TRUE(cuts(cracks, {2, -1}, {2, 0.5}));    // towards the tip, across the first piece
    EXPECT_TRUE(cuts(cracks, {2, -1}, {2.25, 1.5})); // beside the tip
    EXPECT_TRUE(cuts(cracks, {1, -1}, {2.5, 1.25})); // across the first piece only
    EXPECT_TRUE(cuts(cracks, {1, 1}, {5, 1}));       // through the tip and across the third piece
    EXPECT_FALSE(cuts(cracks, {1, 1}, {3, 1}));      // through the tip only
    EXPECT_TRUE(cuts(cracks, {1, 1.5}, {3, 1.5}));
  }
}

TEST(BondCuts, ThroughACornerIsCut)
{
  const CrackSet straight({{{1, 1}, {2, 1}, {3, 1}}}, kBody), bent({{{1, 1}, {2, 1}, {3, 2}}}, kBody);
  for (const CrackSet* cracks : {&straight, &bent}) {
    EXPECT_TRUE(cuts(*cracks, {2, 0}, {2, 2}));
    EXPECT_TRUE(cuts(*cracks, {1.5, 2}, {2.5, 0}));
  }
}

TEST(BondCuts, TouchingACornerFromOutsideStaysOnTheLeftOnly)
{
  const Polyline roof{{1, 0}, {2, 1}, {3, 0}}, back{{3, 0}, {2, 1}, {1, 0}};
  EXPECT_FALSE(cuts(CrackSet({roof}, kBody), {1, 1}, {3, 1}));
  EXPECT_FALSE(cuts(CrackSet({roof}, kBody), {1, 1 - 1e-15}, {3, 1 - 1e-15})); // rounding
  EXPECT_TRUE(cuts(CrackSet({roof}, kBody), {1, 1 - 1e-9}, {3, 1 - 1e-9})); // through the wedge: there and back again
  EXPECT_TRUE(cuts(CrackSet({back}, kBody), {1, 1}, {3, 1}));               // on its left, where the wedge is
  EXPECT_FALSE(cuts(CrackSet({back}, kBody), {1, 1 + 1e-9}, {3, 1 + 1e-9}));
}

TEST(BondCuts, AnEndOnTheCrackIsOnItsLeft)
{
  const CrackSet cracks({{{1, 1}, {3, 1}}}, kBody);
  EXPECT_FALSE(cuts(cracks, {2, 1}, {2, 2}));
  EXPECT_TRUE(cuts(cracks, {2, 1}, {2, 0}));
  EXPECT_FALSE(cuts(cracks, {1.5, 1}, {2.5, 1}));
  const CrackSet valley({{{1, 2}, {2, 1}, {3, 2}}}, kBody); // left turn: above is left
  EXPECT_FALSE(cuts(valley, {2, 1}, {2, 3}));
  EXPECT_TRUE(cuts(valley, {2, 1}, {2, 0}));
  EXPECT_TRUE(cuts(valley, {2, 1}, {3, 1.5}));
  EXPECT_FALSE(cuts(valley, {2, 1}, {2.5, 1.5}));         // along the crack
  const CrackSet roof({{{1, 0}, {2, 1}, {3, 0}}}, kBody); // right turn: above is left
  EXPECT_FALSE(cuts(roof, {2, 1}, {3, 0.5}));
  EXPECT_TRUE(cuts(roof, {2, 1}, {2, 0}));
}

TEST(BondCuts, RunningAlongAPieceIsCutIfItLeavesToTheOtherSide)
{
  // A step: along y = 1 from left, then up; or a Z whose middle piece lies in the bond.
  const CrackSet zig({{{1, 2}, {2, 1}, {3, 1}, {4, 0}}}, kBody), tub({{{1, 2}, {2, 1}, {3, 1}, {4, 2}}}, kBody);
  EXPECT_TRUE(cuts(zig, {1, 1}, {4, 1})); // from right of it (below) to left
  EXPECT_TRUE(cuts(tub, {1, 1}, {4, 1})); // what is on the crack is in the tub
  EXPECT_FALSE(cuts(tub, {1, 1 - 1e-9}, {4, 1 - 1e-9}));
  EXPECT_FALSE(cuts(zig, {2.5, 1}, {4, 1})); // an end on the crack is left, and so is (4, 1)
  EXPECT_TRUE(cuts(zig, {1, 1}, {2.5, 1}));  // the other end is right
  EXPECT_TRUE(cuts(tub, {2.5, 1}, {4, 1}));
}

TEST(BondCuts, BondsAcrossThePlaneOnlyAreNever)
{
  const CrackSet cracks({{{1, 1}, {3, 1}}}, kBody);
  EXPECT_FALSE(cracks.cuts({2, 1}, {2, 1}));
  EXPECT_FALSE(CrackSet().cuts({2, 0}, {2, 2}));
}

// Points that are meant to lie on a slanted crack are a little off it; none of their bonds is cut but those to its
// right.
TEST(BondCuts, RoundingPutsNothingAcross)
{
  const double angle = 0.7;
  const Vector<2> along(std::cos(angle), std::sin(angle)), left(-along.y(), along.x());
  const CrackSet cracks({{{-60.0 * along.x(), -60.0 * along.y()}, {70.0 * along.x(), 70.0 * along.y()}}}, kBody);
  for (int k = -30; k < 30; ++k) {
    const Vector<2> on = (0.1 * k) * along;
    EXPECT_EQ(cracks.side(0, on), 1);
    EXPECT_FALSE(cuts(cracks, on, (0.1 * k + 0.3) * along));
    EXPECT_FALSE(cuts(cracks, on, on + 0.2 * left));
    EXPECT_TRUE(cuts(cracks, on, on - 0.2 * left));
  }
}

// The line through a bond far away may go through a tip by chance.
TEST(BondCuts, ATipElsewhereOnTheLineOfABondKeepsNothing)
{
  const CrackSet cracks({{{0, 1}, {2, 0}, {5, 3}}}, kBody);
  EXPECT_TRUE(cuts(cracks, {2, 1}, {4, 1}));
}

TEST(BondCuts, AnyCrackOfTheSetCuts)
{
  const CrackSet cracks({{{1, 1}, {3, 1}}, {{5, 0}, {5, 2}}}, kBody);
  EXPECT_TRUE(cuts(cracks, {2, 0}, {2, 2}));
  EXPECT_TRUE(cuts(cracks, {4, 1.5}, {6, 1.5}));
  EXPECT_FALSE(cuts(cracks, {4, 0}, {4, 2}));
  EXPECT_FALSE(cracks.cuts(0, {4, 1.5}, {6, 1.5}));
}

TEST(BondCuts, NearNeverMissesACutBond)
{
  const CrackSet cracks({{{0.1, 0.2}, {0.5, 0.6}}}, kBody);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1.0, 2.0);
  for (int k = 0; k < 5000; ++k) {
    const Vector<2> a(place(random), place(random)), b = a + 0.3 * Vector<2>(place(random), place(random));
    EXPECT_TRUE(!cracks.cuts(a, b) || cracks.near(a, (b - a).norm()));
  }
  EXPECT_FALSE(cracks.near({2.0, 0.3}, 1.0));
}

// A straight crack from end to end: cut exactly where the sides differ, for slopes and places that doubles round.
TEST(BondCuts, AgreeWithSides)
{
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    const Vector<2> middle(uniform(random), uniform(random)), along(uniform(random), uniform(random));
    const CrackSet cracks({{middle - 50 * along, middle + 50 * along}}, kBody);
    for (int n = 0; n < 50; ++n) {
      const Vector<2> a =
          n % 2 ? Vector<2>(middle + uniform(random) * along) : Vector<2>(uniform(random), uniform(random));
      const Vector<2> b(uniform(random), uniform(random));
      EXPECT_EQ(cuts(cracks, a, b), cracks.side(0, a) != cracks.side(0, b));
    }
  }
}

/// The chain shifted to its right by `by`, corners mitred and then off their bisectors, where bonds may run.
Polyline shifted(const Polyline& chain, double by)
{
  const auto right = [](const Vector<2>& a, const Vector<2>& b) {
    const Vector<2> d = (b - a).normalized();
    return Vector<2>(d.y(), -d.x());
  };
  Polyline moved;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    const Vector<2> in = k > 0 ? right(chain[k - 1], chain[k]) : right(chain[0], chain[1]);
    const Vector<2> out = k + 1 < chain.size() ? right(chain[k], chain[k + 1]) : in;
    const Vector<2> off = k % 2 ? Vector<2>(0.84, 0.54) : Vector<2>(-0.42, 0.91);
    moved.push_back(chain[k] + by * ((in + out) / (1.0 + in.dot(out)) + 0.01 * off));
  }
  return moved;
}

/// Plain crossings, for segments that do not touch.
int crossings(const Polyline& chain, const Vector<2>& a, const Vector<2>& b)
{
  const auto cross = [](const Vector<2>& p, const Vector<2>& q, const Vector<2>& x) {
    return (q - p).x() * (x - p).y() - (q - p).y() * (x - p).x();
  };
  int count = 0;
  for (std::size_t k = 0; k + 1 < chain.size(); ++k)
    count += cross(chain[k], chain[k + 1], a) * cross(chain[k], chain[k + 1], b) < 0.0 &&
             cross(a, b, chain[k]) * cross(a, b, chain[k + 1]) < 0.0;
  return count;
}

// On whole numbers corners, ends and pieces coincide all the time. The crack really shifted to its right by 1e-7 meets
// nothing by chance, so counting its crossings tells what must be cut. Bonds that touch an end are left to other tests.
TEST(BondCuts, SeeTheCrackShiftedToItsRight)
{
  std::mt19937 random(5);
  std::uniform_int_distribution<int> coordinate(0, 5);
  const auto point = [&] { return Vector<2>(coordinate(random), coordinate(random)); };
  int cut = 0, kept = 0, touching = 0;
  for (int k = 0; k < 3000; ++k) {
    const Polyline chain{Vector<2>(-20, coordinate(random)), point(), point(), point(),
                         Vector<2>(30, coordinate(random))};
    CrackSet cracks;
    try {
      cracks = CrackSet({chain}, kBody);
    } catch (const std::runtime_error&) {
      continue; // crosses itself or has a point twice
    }
    const Polyline moved = shifted(chain, 1e-7);
    for (int n = 0; n < 30; ++n) {
      const Vector<2> a = point(), b = point();
      if (a == b) continue;
      const int met = crossings(moved, a, b);
      const bool is_cut = cuts(cracks, a, b);
      if (met % 2 == 1) {
        EXPECT_TRUE(is_cut);
        ++cut;
      } else if (met == 0) {
        EXPECT_FALSE(is_cut);
        ++kept;
      } else {
        ++touching;
      }
    }
  }
  EXPECT_GT(cut, 5000);
  EXPECT_GT(kept, 5000);
  EXPECT_GT(touching, 100);
}
} // namespace
