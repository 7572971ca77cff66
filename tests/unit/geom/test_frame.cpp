#include "pdx/geom/frame.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

using namespace pdx;
using geom::Frame;

namespace {
Frame around(const Vector<2>& corner) { return Frame(geom::Box<2>{corner, corner + Vector<2>(1.0, 1.0)}); }
} // namespace

TEST(Frame, WithoutABodyLeavesPlacesAlone)
{
  const Vector<2> x(0.1 + 0.2, 1.0 / 3.0);
  EXPECT_EQ(Frame().inside(x), x);
  EXPECT_EQ(Frame().given<2>(x), x);
  EXPECT_EQ(Frame().step(), 0.0);
}

TEST(Frame, DecimalsAreTheSameToTheLastBitWhereverTheBodyLies)
{
  for (const Vector<2>& corner : {Vector<2>(0.0, 0.0), Vector<2>(5e5, 4.5e6), Vector<2>(1e3, -1e3),
                                  Vector<2>(1.0 / 3.0, std::numbers::pi), Vector<2>(-1e9, 123456789.125)}) {
    const Frame frame = around(corner);
    for (int k = 0; k <= 80; ++k) {
      const double x = k / 80.0; // decimals of four digits
      EXPECT_EQ(frame.inside(Vector<2>(corner.x() + x, corner.y() + x)), Vector<2>(x, x)) << corner.transpose();
    }
  }
}

TEST(Frame, OtherNumbersMoveByHalfAStepAtMostAndComeBack)
{
  const Vector<2> corner(5e5, 4.5e6);
  const Frame frame = around(corner);
  EXPECT_DOUBLE_EQ(frame.step(), 1e-8);
  const Vector<2> x(1.0 / 3.0, std::sqrt(0.5));
  const Vector<2> inside = frame.inside(Vector<2>(corner + x));
  EXPECT_LE((inside - x).cwiseAbs().maxCoeff(), 0.5e-8 + 1e-9);
  EXPECT_LE((frame.given<2>(inside) - corner - x).cwiseAbs().maxCoeff(), 0.5e-8 + 1e-9);
  EXPECT_EQ(frame.text(x), "(500000.3333, 4500000.707)");
}

TEST(Frame, StepFollowsTheSizeOfTheBodyAtTheOrigin)
{
  EXPECT_DOUBLE_EQ(around({0.0, 0.0}).step(), 1e-14);
  EXPECT_DOUBLE_EQ(Frame(geom::Box<2>{{0.0, 0.0}, {3e5, 1.0}}).step(), 1e-8);
  EXPECT_DOUBLE_EQ(Frame(geom::Box<2>{{0.0, 0.0}, {2e-6, 1e-6}}).step(), 1e-19);
  EXPECT_DOUBLE_EQ(Frame(geom::Box<2>{{0.0, 0.0}, {3e17, 1.0}}).step(), 1e4);
  EXPECT_EQ(Frame(geom::Box<2>{{0.0, 0.0}, {3e17, 1.0}}).inside(Vector<2>(123456.0, 0.0)).x(), 120000.0);
}

TEST(Frame, PlacesFarOutsideTheBodyAreLeftAlone)
{
  const Frame frame = around({0.0, 0.0});
  EXPECT_EQ(frame.inside(Vector<2>(-1e300, 1e9)), Vector<2>(-1e300, 1e9));
}
