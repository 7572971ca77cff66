#include "pdx/geom/polygon.hpp"

#include <cmath>
#include <gtest/gtest.h>

using namespace pdx;

namespace {
const std::array<Vector<2>, 4> kSquare{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}};
const std::array<Vector<2>, 3> kTriangle{{{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}};

double integral(std::span<const Vector<2>> corners, int p, int q)
{
  double sum = 0.0;
  for (const auto& [x, weight] : geom::quadrature(corners)) sum += weight * std::pow(x.x(), p) * std::pow(x.y(), q);
  return sum;
}
} // namespace

TEST(Polygon, SplitOfASquareByAVerticalLineHasTwoRectangles)
{
  const std::array distance{-0.25, 0.75, 0.75, -0.25}; // x - 0.25
  const auto [minus, plus] = geom::split(kSquare, distance);
  EXPECT_EQ(minus.size(), 4u);
  EXPECT_EQ(plus.size(), 4u);
  EXPECT_DOUBLE_EQ(geom::area(minus), 0.25);
  EXPECT_DOUBLE_EQ(geom::area(plus), 0.75);
}

TEST(Polygon, LineThatCutsOffACornerLeavesATriangleAndAPentagon)
{
  const std::array distance{-0.5, 0.5, 1.5, 0.5}; // x + y - 0.5
  const auto [minus, plus] = geom::split(kSquare, distance);
  EXPECT_EQ(minus.size(), 3u);
  EXPECT_EQ(plus.size(), 5u);
  EXPECT_DOUBLE_EQ(geom::area(minus), 0.125);
  EXPECT_DOUBLE_EQ(geom::area(plus), 0.875);
}

TEST(Polygon, LineThroughTwoCornersSplitsWithoutNewPoints)
{
  const std::array distance{0.0, 1.0, 0.0, -1.0}; // x - y
  const auto [minus, plus] = geom::split(kSquare, distance);
  EXPECT_EQ(minus.size(), 3u);
  EXPECT_EQ(plus.size(), 3u);
  EXPECT_DOUBLE_EQ(geom::area(plus), 0.5);
}

TEST(Polygon, LineAlongAnEdgeOrThroughOneCornerLeavesTheOtherPartEmpty)
{
  for (const std::array<double, 4>& distance : {std::array{0.0, 0.0, 1.0, 1.0}, std::array{0.0, 1.0, 2.0, 1.0}}) {
    const auto [minus, plus] = geom::split(kSquare, distance);
    EXPECT_TRUE(minus.empty());
    EXPECT_DOUBLE_EQ(geom::area(plus), 1.0);
  }
}

TEST(Polygon, QuadratureIntegratesDegreeFourExactlyAndDegreeFiveNot)
{
  for (int p = 0; p <= 4; ++p)
    for (int q = 0; p + q <= 4; ++q) {
      // On the unit square 1 / ((p + 1)(q + 1)); on the triangle p! q! / (p + q + 2)!.
      EXPECT_NEAR(integral(kSquare, p, q), 1.0 / ((p + 1) * (q + 1)), 1e-15);
      const double triangle = std::tgamma(p + 1) * std::tgamma(q + 1) / std::tgamma(p + q + 3);
      EXPECT_NEAR(integral(kTriangle, p, q), triangle, 1e-15);
    }
  EXPECT_GT(std::abs(integral(kTriangle, 5, 0) - 1.0 / 42.0), 1e-6);
}

TEST(Polygon, QuadraturesOfBothPartsAddUpToTheWhole)
{
  for (const std::array<double, 4>& distance :
       {std::array{-0.3, 0.2, 0.9, 0.4}, std::array{-0.5, 0.5, 1.5, 0.5}, std::array{-1e-9, 1.0, 2.0, 1.0}}) {
    const auto [minus, plus] = geom::split(kSquare, distance);
    EXPECT_NEAR(integral(minus, 3, 1) + integral(plus, 3, 1), 0.125, 1e-15);
    EXPECT_NEAR(integral(minus, 2, 2) + integral(plus, 2, 2), 1.0 / 9.0, 1e-15);
  }
}
