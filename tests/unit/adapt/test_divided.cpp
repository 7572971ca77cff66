#include "pdx/adapt/divided.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using adapt::Corners;

namespace {
Corners rectangle(double x0, double y0, double x1, double y1)
{
  return {Vector<2>(x0, y0), Vector<2>(x1, y0), Vector<2>(x1, y1), Vector<2>(x0, y1)};
}

geom::Lattice<2> lattice(double x, double y, double dx)
{
  geom::Lattice<2> all;
  all.origin = {x, y};
  all.dx = dx;
  return all;
}
} // namespace

TEST(Divided, AnElementOfWholeSpacingsOnTheLinesOfTheLatticeIs)
{
  EXPECT_TRUE(adapt::is_divided(rectangle(0.3, 0.6, 0.7, 0.8), lattice(0.0, 0.0, 0.1)));
  EXPECT_TRUE(adapt::is_divided(rectangle(-0.7, -0.6, -0.3, -0.2), lattice(0.1, 0.2, 0.1)));
}

TEST(Divided, OneBesideTheLinesOrOfABrokenNumberIsNot)
{
  EXPECT_FALSE(adapt::is_divided(rectangle(0.35, 0.6, 0.75, 0.8), lattice(0.0, 0.0, 0.1)));
  EXPECT_FALSE(adapt::is_divided(rectangle(0.3, 0.6, 0.55, 0.8), lattice(0.0, 0.0, 0.1)));
}

TEST(Divided, OneThatIsNoBoxIsNot)
{
  Corners skew = rectangle(0.0, 0.0, 0.4, 0.4);
  EXPECT_TRUE(adapt::is_box(skew, 1e-7));
  skew[2][0] = 0.3; // still on a line
  EXPECT_FALSE(adapt::is_box(skew, 1e-7));
  EXPECT_FALSE(adapt::is_divided(skew, lattice(0.0, 0.0, 0.1)));
}

TEST(Divided, RoundingDoesNotDecide)
{
  EXPECT_TRUE(adapt::is_divided(rectangle(1.0 / 3.0, 0.0, 1.0, 2.0 / 3.0 + 1e-12), lattice(0.0, 0.0, 1.0 / 12.0)));
}
