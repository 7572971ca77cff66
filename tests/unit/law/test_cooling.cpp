// Shares of temperature in a wall against other series and against printed values.
#include "pdx/law/cooling.hpp"
#include "pdx/law/temperature_table.hpp"

#include <cmath>
#include <gtest/gtest.h>

using pdx::Vector;
using pdx::law::CooledWall;
using pdx::law::Cooling;
using pdx::law::TemperatureTable;

namespace {
constexpr double kAtOnce = std::numeric_limits<double>::infinity();

/// A wall whose face takes on the medium's temperature at once, by images of the half space, which fall off at any time
/// at which the other series is slow, and the other way round.
double by_images(double depth, double fourier)
{
  double sum = 1.0;
  const double scale = 2.0 * std::sqrt(fourier);
  for (int n = 0; n < 60; ++n)
    sum -= (n % 2 ? -1.0 : 1.0) * (std::erfc((2.0 * n + depth) / scale) + std::erfc((2.0 * n + 2.0 - depth) / scale));
  return sum;
}
} // namespace

TEST(CooledWall, IsThatOfImagesEarlyAndLate)
{
  const CooledWall wall(kAtOnce);
  for (const double fourier : {1e-6, 1e-4, 4e-3, 6e-3, 0.02, 0.1, 0.5, 1.0})
    for (const double depth : {0.0, 0.01, 0.1, 0.35, 0.7, 1.0})
      EXPECT_NEAR(wall.share(depth, fourier), by_images(depth, fourier), 2e-14) << fourier << " " << depth;
}

TEST(CooledWall, HasTheCoefficientsOfTheTextbook)
{
  // Bi, z_1, C_1 [Incropera, DeWitt: Fundamentals of Heat and Mass Transfer, table 5.1], four digits
  const double rows[][3] = {
      {0.1, 0.3111, 1.0161}, {1.0, 0.8603, 1.1191}, {10.0, 1.4289, 1.2620}, {100.0, 1.5552, 1.2731}};
  for (const auto& [biot, z, c] : rows) {
    const CooledWall wall(biot);
    const double late = 2.0, later = 3.0; // one term is left
    EXPECT_NEAR(std::sqrt(std::log(wall.share(1.0, late) / wall.share(1.0, later))), z, 6e-5) << biot;
    EXPECT_NEAR(wall.share(1.0, late) * std::exp(late * std::log(wall.share(1.0, late) / wall.share(1.0, later))), c,
                6e-5);
  }
}

TEST(CooledWall, HalfSpaceAndSeriesMeet)
{
  for (const double biot : {0.3, 11.3, 2000.0}) {
    const CooledWall wall(biot);
    for (const double depth : {0.0, 0.05, 0.2, 1.0})
      EXPECT_NEAR(wall.share(depth, 0.005 * (1.0 - 1e-12)), wall.share(depth, 0.005), 1e-10) << biot << " " << depth;
  }
}

TEST(CooledWall, LosesThroughItsFaceWhatItHolds)
{
  // d/dFo of the mean over the depth is -Bi share(0), whatever the formula
  const CooledWall wall(7.0);
  for (const double fourier : {2e-3, 0.05}) {
    const auto mean = [&](double fo) {
      double sum = 0.0;
      const int n = 4000; // Simpson
      for (int k = 0; k <= n; ++k) sum += (k == 0 || k == n ? 1.0 : k % 2 ? 4.0 : 2.0) * wall.share(k / double(n), fo);
      return sum / (3.0 * n);
    };
    const double step = 1e-3 * fourier;
    EXPECT_NEAR((mean(fourier + step) - mean(fourier - step)) / (2.0 * step), -7.0 * wall.share(0.0, fourier), 1e-4);
  }
}

TEST(Cooling, OfACornerIsAProductOfWalls)
{
  const Cooling cooling({{{1.0, 2.0}, {5.0, 4.0}}, {true, false, false, true}, 0.5, 2.0, 3.0});
  const auto share = cooling.share(0.25);
  const Vector<2> x(1.8, 3.1);
  EXPECT_NEAR(share(x), CooledWall(6.0).share(0.2, 0.125 / 16.0) * CooledWall(3.0).share(0.45, 0.125 / 4.0), 1e-15);
  // Cooled on both sides, a wall is as thick as its half.
  const Cooling both({{{1.0, 2.0}, {5.0, 4.0}}, {true, true, false, false}, 0.5, 2.0, 3.0});
  EXPECT_NEAR(both.share(0.25)({1.8, 3.1}), CooledWall(3.0).share(0.4, 0.125 / 4.0), 1e-15);
  EXPECT_NEAR(both.share(0.25)({4.2, 2.1}), CooledWall(3.0).share(0.4, 0.125 / 4.0), 1e-14);
}

TEST(TemperatureTable, IsStraightBetweenAndEvenBeyond)
{
  const TemperatureTable table{{{{0.0, 2.0}, {0.0, 1.0}, {0.0}}}, {10.0, 20.0, 30.0, 60.0}};
  EXPECT_DOUBLE_EQ(table.at({0.5, 3.0}, 0.0), 15.0);
  EXPECT_DOUBLE_EQ(table.at({0.5, -1.0}, 1.0), 30.0);
  EXPECT_DOUBLE_EQ(table.at({7.0, 0.0}, 9.0), 60.0);
}
