#include "pdx/field/staying_rows.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using field::StayingRows;

namespace {
/// Seven rows of which 0, 1 stay where they are, 3, 4 come behind what was 6, and 2 and 5 go; two are new.
StayingRows some() { return {7, 7, {{0, 0, 2}, {3, 4, 2}, {6, 3, 1}}, {}}; }
} // namespace

TEST(StayingRows, TellWhatGoesAndWhatComes)
{
  EXPECT_EQ(some().leaving(), (std::vector<Index>{2, 5}));
  EXPECT_EQ(some().coming(), (std::vector<Index>{2, 6}));
  const StayingRows behind = some().behind(3, 3);
  EXPECT_EQ(behind.leaving(), (std::vector<Index>{2}));
  EXPECT_EQ(behind.coming(), (std::vector<Index>{3}));
}

TEST(StayingRows, CarryValuesInPlace)
{
  std::vector<double> values{0, .5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5, 5.5, 6, 6.5};
  some().carry(values, 2);
  EXPECT_EQ(values, (std::vector<double>{0, .5, 1, 1.5, 0, 0, 6, 6.5, 3, 3.5, 4, 4.5, 0, 0}));
}

TEST(StayingRows, WithoutRunsEverythingGoesAndComes)
{
  const StayingRows none{2, 3, {}, {}};
  std::vector<double> values{1, 2};
  none.carry(values, 1);
  EXPECT_EQ(values, (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(none.coming(), (std::vector<Index>{0, 1, 2}));
}
