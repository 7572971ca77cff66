#include "pdx/pd/surface.hpp"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <map>

namespace pdx::test::surface {
namespace {
constexpr Index kWide = 40, kHigh = 30;
constexpr double kDx = 0.25;

const pd::Stencil<2>& stencil()
{
  static const auto made = pd::make_stencil<2>({kDx,
                                                1.0,
                                                4.0 * kDx,
                                                law::Micromodulus::conical,
                                                pd::Calibration::lattice,
                                                {1.0, 1.0 / 3.0, law::Plane::stress, 1.0}});
  return made;
}
const pd::SideWeights& weights()
{
  static const auto solved = *pd::SideWeights::solve(stencil(), pd::SideWeights::Aim::bending);
  return solved;
}
geom::Lattice<2> lattice() { return {{1.0, 2.0}, kDx, {kWide, kHigh}}; }
bool in_lattice(const Site<2>& site) { return lattice().contains(site); }
crack::CrackSet crack_along(std::vector<crack::Polyline> lines)
{
  return {std::move(lines), geom::Box<2>{{1.0, 2.0}, {1.0 + kWide * kDx, 2.0 + kHigh * kDx}}};
}

/// Factors of all bonds, by their lower end and arm.
class Factors {
public:
  explicit Factors(const pd::Exists<2>& exists = in_lattice, const crack::CrackSet* cracks = nullptr)
      : factors_(pd::correct_sides(stencil(), weights(), exists, cracks)({lattice(), {0, 0}, {kWide, kHigh}}))
  {}
  /// Of the bond between two sites, in any order.
  double operator()(Site<2> a, Site<2> b) const
  {
    if (b[1] < a[1] || (b[1] == a[1] && b[0] < a[0])) std::swap(a, b);
    if (!factors_.any(a)) return 1.0;
    for (std::size_t h = 0; h < stencil().half.size(); ++h)
      if (stencil().half[h].step == Site<2>{b[0] - a[0], b[1] - a[1]}) return factors_.of(a, h);
    ADD_FAILURE() << "no bond";
    return 0.0;
  }

private:
  pd::BondFactors<2> factors_;
};

template <class Visit> void for_each_bond(Visit&& visit)
{
  for (Index y = 0; y < kHigh; ++y)
    for (Index x = 0; x < kWide; ++x)
      for (const pd::Arm<2>& arm : stencil().half)
        if (const Site<2> other{x + arm.step[0], y + arm.step[1]}; in_lattice(other)) visit(Site<2>{x, y}, other);
}

TEST(CorrectSides, CountsRowsFromEachSide)
{
  const Factors factor;
  EXPECT_EQ(factor({20, 0}, {21, 2}), weights().at(0, 1, 2));
  EXPECT_EQ(factor({20, 1}, {23, 1}), weights().at(1, 3, 0));
  EXPECT_EQ(factor({20, kHigh - 4}, {21, kHigh - 1}), weights().at(0, 1, 3)); // by its upper end
  EXPECT_EQ(factor({2, 15}, {5, 16}), weights().at(2, 1, 3));                 // across and along change places
  EXPECT_EQ(factor({kWide - 1, 15}, {kWide - 3, 16}), weights().at(0, 1, 2));
  EXPECT_EQ(factor({20, 3}, {20, 6}), 1.0);
  EXPECT_NE(factor({20, 2}, {20, 5}), 1.0);
}

TEST(CorrectSides, SidesThatMeetMultiply)
{
  const Factors factor;
  EXPECT_EQ(factor({1, 0}, {3, 1}), weights().at(0, 2, 1) * weights().at(1, 1, 2));
  EXPECT_EQ(factor({1, kHigh - 1}, {0, kHigh - 3}), weights().at(0, 1, 2) * weights().at(0, 2, 1));
}

TEST(CorrectSides, MirroredAndTurnedBondsHaveTheSameFactor)
{
  const Factors factor;
  for_each_bond([&](const Site<2>& a, const Site<2>& b) {
    const auto mirrored = [](const Site<2>& s) { return Site<2>{kWide - 1 - s[0], s[1]}; };
    const auto turned = [](const Site<2>& s) { return Site<2>{kWide - 1 - s[0], kHigh - 1 - s[1]}; };
    EXPECT_NEAR(factor(mirrored(a), mirrored(b)), factor(a, b), 1e-14);
    EXPECT_NEAR(factor(turned(a), turned(b)), factor(a, b), 1e-14);
  });
}

TEST(CorrectSides, WhereTheBodyGoesOnThereIsNoSide)
{
  const Factors factor([](const Site<2>& site) { return site[1] >= 0 && site[1] < kHigh; });
  for_each_bond([&](const Site<2>& a, const Site<2>& b) {
    const bool near = std::min(a[1], b[1]) < 3 || std::max(a[1], b[1]) >= kHigh - 3;
    if (!near) {
      EXPECT_EQ(factor(a, b), 1.0);
    }
  });
  EXPECT_EQ(factor({0, 0}, {3, 1}), weights().at(0, 3, 1)); // the side goes on too
}

/// A crack from the left, mid-height, to the middle of the body: rows 14 and 15 are its faces.
TEST(CorrectSides, FacesOfACrackAreSidesUntilAReachBehindItsTip)
{
  const double y = 2.0 + 15 * kDx, tip = 1.0 + 20.0 * kDx;
  const auto cracks = crack_along({{{1.0, y}, {tip, y}}});
  const Factors factor(in_lattice, &cracks);
  EXPECT_EQ(factor({10, 15}, {11, 17}), weights().at(0, 1, 2));
  EXPECT_EQ(factor({10, 14}, {11, 12}), weights().at(0, 1, 2));
  EXPECT_EQ(factor({10, 16}, {10, 18}), weights().at(1, 0, 2));
  EXPECT_EQ(factor({16, 15}, {16, 17}), weights().at(0, 0, 2)); // columns 17, 18, 19 are the reach
  EXPECT_EQ(factor({17, 15}, {17, 17}), 1.0);
  EXPECT_EQ(factor({22, 15}, {22, 17}), 1.0);
  EXPECT_EQ(factor({0, 15}, {1, 17}), weights().at(0, 1, 2) * weights().at(0, 2, 1)); // at the mouth a corner
}

TEST(CorrectSides, SlantedCracksAndReentrantCornersAreLeft)
{
  const auto cracks = crack_along({{{1.0 + 10 * kDx, 2.0 + 10 * kDx}, {1.0 + 28.3 * kDx, 2.0 + 19.1 * kDx}}});
  const Factors slanted(in_lattice, &cracks);
  for_each_bond([&](const Site<2>& a, const Site<2>& b) {
    for (const Site<2>& s : {a, b})
      if (s[0] < 6 || s[1] < 6 || s[0] >= kWide - 6 || s[1] >= kHigh - 6) return;
    EXPECT_EQ(slanted(a, b), 1.0);
  });
  // The body goes on below, but only right of column 20.
  const Factors corner([](const Site<2>& s) { return in_lattice(s) || (s[1] < 0 && s[0] > 20); });
  EXPECT_EQ(corner({10, 0}, {11, 2}), weights().at(0, 1, 2));
  EXPECT_EQ(corner({18, 0}, {18, 2}), 1.0); // within a reach of the corner, where the side ends
  EXPECT_EQ(corner({21, 0}, {21, 2}), 1.0);
  EXPECT_EQ(corner({30, 0}, {30, 2}), 1.0);
}

/// Two rows' window says the same as the whole lattice.
TEST(CorrectSides, AnyWindowSaysTheSame)
{
  const double y = 2.0 + 15 * kDx;
  const auto cracks = crack_along({{{1.0, y}, {1.0 + 20.0 * kDx, y}}});
  const auto correction = pd::correct_sides(stencil(), weights(), in_lattice, &cracks);
  const auto whole = correction({lattice(), {0, 0}, {kWide, kHigh}});
  for (const Site<2>& lower : {Site<2>{0, 12}, Site<2>{14, 13}, Site<2>{33, 20}}) {
    const auto part = correction({lattice(), lower, {7, 4}});
    for (Site<2> site = lower; site[1] < lower[1] + 4; ++site[1])
      for (site[0] = lower[0]; site[0] < lower[0] + 7; ++site[0]) {
        EXPECT_EQ(part.any(site), whole.any(site));
        for (std::size_t h = 0; h < stencil().half.size(); ++h) {
          const Site<2>& step = stencil().half[h].step;
          if (!in_lattice({site[0] + step[0], site[1] + step[1]})) continue;
          EXPECT_EQ(part.of(site, h), whole.of(site, h)) << site[0] << " " << site[1] << " " << h;
        }
      }
  }
}
} // namespace
} // namespace pdx::test::surface
