#include "pdx/field/row_name.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

using namespace pdx;
using field::RowName;

TEST(RowName, OrdersByKindThenByKey)
{
  const std::vector<RowName> names{RowName(),
                                   RowName::node(0),
                                   RowName::node(2147483647),
                                   RowName::set(0, 0),
                                   RowName::set(0, 7),
                                   RowName::set(1, 0),
                                   RowName::set(2147483647, 16777215),
                                   RowName::particle(0),
                                   RowName::particle(1ULL << 50)};
  for (std::size_t k = 0; k + 1 < names.size(); ++k) EXPECT_TRUE(names[k] < names[k + 1]) << k;
}

TEST(RowName, KeepsKindAndKey)
{
  EXPECT_EQ(RowName().value(), 0U);
  EXPECT_EQ(RowName().kind(), RowName::Kind::none);
  EXPECT_EQ(RowName::node(12).kind(), RowName::Kind::node);
  EXPECT_EQ(RowName::node(12).key(), 12U);
  EXPECT_EQ(RowName::set(12, 3).kind(), RowName::Kind::set);
  const RowName site = RowName::particle(987654321012345ULL);
  EXPECT_EQ(site.kind(), RowName::Kind::particle);
  EXPECT_EQ(site.key(), 987654321012345ULL);
  EXPECT_EQ(RowName::from(site.value()), site);
}
