#include "pdx/law/scatter.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

using namespace pdx;

/// Mean 0, mean square 1/3 of what is even in -1 to 1; neighbours and other draws have nothing to do with it.
TEST(Scatter, IsEvenAndOfEachSiteApart)
{
  const law::Scatter scatter{0.1, 5}, other{0.1, 6};
  const auto z = [](const law::Scatter& s, std::int64_t i, std::int64_t j) { return s.at(std::array{i, j}); };
  double sum = 0.0, squares = 0.0, right = 0.0, above = 0.0, draws = 0.0;
  constexpr int kHalf = 100, kCount = 4 * kHalf * kHalf; // on both sides of the corner of the body
  for (std::int64_t i = -kHalf; i < kHalf; ++i)
    for (std::int64_t j = -kHalf; j < kHalf; ++j) {
      const double here = z(scatter, i, j);
      ASSERT_GE(here, -1.0);
      ASSERT_LT(here, 1.0);
      sum += here;
      squares += here * here;
      right += here * z(scatter, i + 1, j);
      above += here * z(scatter, i, j + 1);
      draws += here * z(other, i, j);
    }
  const double deviation = 1.0 / std::sqrt(kCount); // of a mean of what has variance 1
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 * deviation * std::sqrt(1.0 / 3.0));
  EXPECT_NEAR(squares / kCount, 1.0 / 3.0, 4.0 * deviation * std::sqrt(4.0 / 45.0));
  for (const double product : {right, above, draws}) EXPECT_NEAR(product / kCount, 0.0, 4.0 * deviation / 3.0);
}

TEST(Scatter, SharesOfBothEndsStayWithinTheWidth)
{
  const law::Scatter scatter{0.4, 1};
  EXPECT_FALSE(law::Scatter().any());
  EXPECT_DOUBLE_EQ(scatter.least(), 0.6);
  for (std::int64_t i = 0; i < 1000; ++i) EXPECT_LE(std::abs(scatter.share(std::array{i, i})), 0.2);
}
