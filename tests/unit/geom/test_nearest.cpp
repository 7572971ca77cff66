#include "pdx/geom/nearest.hpp"

#include <gtest/gtest.h>

using namespace pdx;

TEST(Nearest, OfASegmentIsExactAtItsEnds)
{
  const Vector<2> a(1.0, 1.0), b(4.0, 1.0);
  EXPECT_EQ(geom::nearest_on_segment<2>(a, b, {0.3, 7.0}), (std::array{1.0, 0.0}));
  EXPECT_EQ(geom::nearest_on_segment<2>(a, b, {4.1, -7.0}), (std::array{0.0, 1.0}));
  EXPECT_NEAR(geom::nearest_on_segment<2>(a, b, {1.75, 3.0})[1], 0.25, 1e-15);
  EXPECT_EQ(geom::nearest_on_segment<2>(a, a, {1.75, 3.0}), (std::array{1.0, 0.0})); // no length
}

TEST(Nearest, OfATriangleIsTheOneThatASearchFinds)
{
  const Vector<3> a(0.0, 0.0, 0.0), b(2.0, 0.1, 0.3), c(0.4, 1.5, -0.2);
  constexpr int kFine = 60;
  for (int i = 0; i < 400; ++i) {
    const Vector<3> x(-1.0 + 0.04 * (i % 20) * 5.0, -1.5 + 0.2 * (i / 20), 0.5 * std::sin(1.7 * i));
    const std::array<double, 3> w = geom::nearest_on_triangle(a, b, c, x);
    EXPECT_NEAR(w[0] + w[1] + w[2], 1.0, 1e-14);
    for (const double weight : w) EXPECT_GE(weight, 0.0);
    const double found = (w[0] * a + w[1] * b + w[2] * c - x).norm();
    double best = 1e300;
    for (int j = 0; j <= kFine; ++j)
      for (int k = 0; k + j <= kFine; ++k)
        best = std::min(best, ((a * (kFine - j - k) + b * j + c * k) / kFine - x).norm());
    EXPECT_LE(found, best + 1e-14);
    EXPECT_GT(found, best - 0.03);
  }
}

TEST(Nearest, OfATriangleIsExactAtItsCorners)
{
  const Vector<3> a(0.0, 0.0, 0.0), b(1.0, 0.0, 0.0), c(0.0, 1.0, 0.0);
  EXPECT_EQ(geom::nearest_on_triangle(a, b, c, {-1.0, -1.0, 1.0}), (std::array{1.0, 0.0, 0.0}));
  EXPECT_EQ(geom::nearest_on_triangle(a, b, c, {3.0, -1.0, 1.0}), (std::array{0.0, 1.0, 0.0}));
  EXPECT_EQ(geom::nearest_on_triangle(a, b, c, {-1.0, 3.0, 1.0}), (std::array{0.0, 0.0, 1.0}));
}
