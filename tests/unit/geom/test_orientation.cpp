#include "pdx/geom/orientation.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace {
using pdx::Vector;
using pdx::geom::orientation;
__extension__ typedef __int128 Wide;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Orientation, TellsLeftFromRight)
{
  EXPECT_EQ(orientation({0, 0}, {1, 0}, {0.3, 1e-300}), 1);
  EXPECT_EQ(orientation({0, 0}, {1, 0}, {0.3, -1.0}), -1);
  EXPECT_EQ(orientation({0, 0}, {1, 0}, {7.0, 0.0}), 0);
  EXPECT_EQ(orientation({2, 3}, {2, 3}, {7.0, 0.0}), 0);
}

// Points on y = x near 0.5 moved by single ulps: plain doubles get many of these signs wrong.
TEST(Orientation, IsRightToTheLastBit)
{
  const double ulp = std::ldexp(1.0, -53);
  for (int i = 0; i < 64; ++i)
    for (int j = 0; j < 64; ++j) {
      const Vector<2> c(0.5 + i * ulp, 0.5 + j * ulp);
      EXPECT_EQ(orientation({12.0, 12.0}, {24.0, 24.0}, c), (j > i) - (j < i)) << i << ' ' << j;
    }
}

// Multiples of 2^-30 up to 2^10: products are exact in 128-bit integers.
TEST(Orientation, AgreesWithIntegers)
{
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int64_t> coordinate(-(std::int64_t{1} << 40), std::int64_t{1} << 40);
  const auto exact = [](std::int64_t ax, std::int64_t ay, std::int64_t bx, std::int64_t by) {
    return static_cast<Wide>(ax) * by - static_cast<Wide>(ay) * bx;
  };
  for (int k = 0; k < 20000; ++k) {
    const std::int64_t ax = coordinate(random), ay = coordinate(random), bx = coordinate(random),
                       by = coordinate(random);
    const std::int64_t cx = ax + (bx - ax) / 3 + k % 3 - 1, cy = ay + (by - ay) / 3; // all but on the line
    const auto d = exact(bx - ax, by - ay, cx - ax, cy - ay);
    const auto v = [](std::int64_t x, std::int64_t y) {
      return Vector<2>(std::ldexp(static_cast<double>(x), -30), std::ldexp(static_cast<double>(y), -30));
    };
    EXPECT_EQ(orientation(v(ax, ay), v(bx, by), v(cx, cy)), (d > 0) - (d < 0));
  }
}

TEST(Orientation, ChangesSignWithTheOrderOfPoints)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 1e-3);
  for (int k = 0; k < 1000; ++k) {
    const Vector<2> a(uniform(random), uniform(random)), b(uniform(random), uniform(random));
    Vector<2> c = a + 0.37 * (b - a);
    if (k % 2) c.y() = std::nextafter(c.y(), k % 4 == 1 ? kInfinity : -kInfinity);
    const int s = orientation(a, b, c);
    EXPECT_EQ(orientation(b, c, a), s);
    EXPECT_EQ(orientation(b, a, c), -s);
    EXPECT_EQ(orientation(c, b, a), -s);
  }
}
} // namespace
