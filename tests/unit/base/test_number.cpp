#include "pdx/base/number.hpp"

#include <cmath>
#include <gtest/gtest.h>

using namespace pdx;

TEST(Number, IsAWholeWordAndMayBeginWithPlus)
{
  EXPECT_EQ(real_in("+5e-2"), 0.05);
  EXPECT_EQ(real_in("-.5"), -0.5);
  EXPECT_TRUE(std::isnan(*real_in("nan")));
  for (const char* word : {"", "+", "+-1", "1 ", "1m", "0x10", "1,5", "1e400", "1d5", "--1"})
    EXPECT_FALSE(real_in(word)) << word;
  EXPECT_FALSE(real_in(std::string(401, '1')));
}

TEST(Number, IsWholeInAnyNotation)
{
  for (const char* word : {"12", "+12", "12.0", "1.2e1", "12."}) EXPECT_EQ(whole_in(word), 12) << word;
  EXPECT_EQ(whole_in("9223372036854775807"), 9223372036854775807);
  for (const char* word : {"1.5", "1e300", "nan", "inf", "two", ""}) EXPECT_FALSE(whole_in(word)) << word;
}
