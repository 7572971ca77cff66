#include "pdx/law/regions.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace pdx::law::regions_test {
namespace {
constexpr double kNever = std::numeric_limits<double>::infinity();

Elastic solid(double young)
{
  Elastic elastic;
  elastic.young = young;
  elastic.poisson = 1.0 / 3.0;
  elastic.density = 1000.0;
  return elastic;
}
geom::Outline box(double from, double to) { return geom::Outline(geom::Outline::edges_of({{from, 0.0}, {to, 1.0}})); }

TEST(Regions, TheLaterOneCountsWhereTheyOverlap)
{
  const Regions regions(solid(1.0), 1.0, 1.0,
                        {{"a", box(0.0, 2.0), solid(1.0), 1.0}, {"b", box(1.0, 3.0), solid(1.0), 1.0}}, {});
  EXPECT_EQ(regions.at({0.5, 0.5}), 1);
  EXPECT_EQ(regions.at({1.5, 0.5}), 2);
  EXPECT_EQ(regions.at({3.5, 0.5}), 0);
  EXPECT_EQ(regions.name(2), "b");
}

TEST(Regions, BondsBetweenAreTwoHalvesInARow)
{
  const Regions regions(solid(2.0), 1.0, 1.0, {{"a", box(0.0, 1.0), solid(6.0), 1.0}}, {});
  EXPECT_EQ(regions.stiffness(0, 0), 1.0);
  EXPECT_EQ(regions.stiffness(1, 1), 3.0);
  EXPECT_EQ(regions.stiffness(0, 1), 1.5); // 1 / (.5 / 1 + .5 / 3)
  EXPECT_EQ(regions.stiffness(1, 0), 1.5);
  EXPECT_FALSE(regions.one_elastic());
}

TEST(Regions, StretchSpendsTheToughnessOfTheWeakerSide)
{
  // A bond k times as stiff that takes g times the energy breaks at sqrt(g / k) of the stretch.
  const Regions regions(solid(1.0), 8.0, 8.0, {{"a", box(0.0, 1.0), solid(4.0), 2.0}}, {});
  EXPECT_EQ(regions.stretch(0, 0), 1.0);
  EXPECT_EQ(regions.stretch(1, 1), 0.25); // sqrt(2 / 8 / 4)
  EXPECT_DOUBLE_EQ(regions.stretch(0, 1), std::sqrt(0.25 / 1.6));
  EXPECT_EQ(regions.least_stretch(), 0.25);
}

TEST(Regions, AnInterfaceHasItsOwnToughness)
{
  const Interface weak{1, 0, 2.0};
  const Regions regions(solid(1.0), 8.0, 8.0, {{"a", box(0.0, 1.0), solid(1.0), 8.0}}, {&weak, 1});
  EXPECT_EQ(regions.stretch(0, 1), 0.5);
  EXPECT_EQ(regions.stretch(1, 0), 0.5);
  EXPECT_EQ(regions.stretch(1, 1), 1.0);
  EXPECT_TRUE(regions.one_elastic());
  EXPECT_FALSE(regions.one_stretch());
}

TEST(Regions, WhatNeverBreaksHoldsBondsToItButForAnInterface)
{
  const Interface weak{2, 0, 8.0};
  const Regions regions(solid(1.0), 8.0, 8.0,
                        {{"a", box(0.0, 1.0), solid(1.0), kNever}, {"b", box(2.0, 3.0), solid(1.0), kNever}},
                        {&weak, 1});
  EXPECT_EQ(regions.stretch(1, 1), kNever);
  EXPECT_EQ(regions.stretch(0, 1), kNever);
  EXPECT_EQ(regions.stretch(0, 2), 1.0);
}

TEST(Regions, EqualOnesChangeNothing)
{
  const Regions regions(solid(3.0), 5.0, 5.0, {{"a", box(0.0, 1.0), solid(3.0), 5.0}}, {});
  EXPECT_TRUE(regions.one_elastic() && regions.one_stretch());
  EXPECT_EQ(regions.stiffness(0, 1), 1.0);
  EXPECT_EQ(regions.stretch(0, 1), 1.0);
}
} // namespace
} // namespace pdx::law::regions_test
