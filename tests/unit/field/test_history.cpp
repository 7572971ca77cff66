#include "pdx/field/history.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace {
using pdx::field::History;

/// Midpoint rule over [0, t], 1e5 intervals.
double summed(const History& h, double t)
{
  double sum = 0.0;
  for (int k = 0; k < 100000; ++k) sum += h.value((k + 0.5) * t / 1e5) * t / 1e5;
  return sum;
}

TEST(History, WithoutAWordIsOne)
{
  const History h;
  EXPECT_EQ(h.value(0.0), 1.0);
  EXPECT_EQ(h.value(7.0), 1.0);
  EXPECT_EQ(h.rate(7.0), 0.0);
  EXPECT_DOUBLE_EQ(h.integral(7.0), 7.0);
}

TEST(History, StepsAtItsTime)
{
  const History h = History::step(2.0);
  EXPECT_EQ(h.value(1.999), 0.0);
  EXPECT_EQ(h.value(2.0), 1.0);
  EXPECT_EQ(h.rate(2.0), 0.0);
  EXPECT_EQ(h.integral(1.5), 0.0);
  EXPECT_DOUBLE_EQ(h.integral(5.0), 3.0);
  EXPECT_DOUBLE_EQ(History::step(0.0).integral(5.0), 5.0);
}

TEST(History, RisesStraight)
{
  const History h = History::ramp(1.0, 4.0);
  EXPECT_EQ(h.value(0.5), 0.0);
  EXPECT_DOUBLE_EQ(h.value(2.0), 0.25);
  EXPECT_EQ(h.value(9.0), 1.0);
  EXPECT_DOUBLE_EQ(h.rate(2.0), 0.25);
  EXPECT_EQ(h.rate(9.0), 0.0);
  EXPECT_NEAR(h.integral(3.0), 0.5, 1e-14);
  EXPECT_NEAR(h.integral(6.0), 3.0, 1e-14);
}

TEST(History, GaussianHasItsClosedForms)
{
  const History h = History::gaussian(3.0, 0.5);
  EXPECT_EQ(h.value(3.0), 1.0);
  EXPECT_NEAR(h.value(3.5), std::exp(-1.0), 1e-15);
  EXPECT_NEAR(h.rate(3.5), -4.0 * std::exp(-1.0), 1e-14);
  EXPECT_NEAR(h.integral(100.0), 0.5 * std::sqrt(std::numbers::pi), 1e-14);
  EXPECT_NEAR(h.integral(3.2), summed(h, 3.2), 1e-9);
}

TEST(History, TableIsStraightBetweenItsPointsAndJumps)
{
  const History h = History::table({{1.0, 2.0}, {2.0, 4.0}, {2.0, -1.0}, {3.0, -1.0}});
  EXPECT_EQ(h.value(0.0), 2.0);
  EXPECT_EQ(h.value(1.5), 3.0);
  EXPECT_EQ(h.value(2.0), -1.0);
  EXPECT_EQ(h.value(9.0), -1.0);
  EXPECT_EQ(h.rate(1.5), 2.0);
  EXPECT_NEAR(h.integral(2.0), 5.0, 1e-12);
  EXPECT_NEAR(h.integral(4.0), 3.0, 1e-12);
  EXPECT_NEAR(h.integral(2.7), summed(h, 2.7), 1e-4);
}
} // namespace
