#include "pdx/geom/clip.hpp"

#include <gtest/gtest.h>

namespace {
using pdx::Vector;
using pdx::geom::Box;
using pdx::geom::clip;
const Box<2> kBox{{0.0, 0.0}, {2.0, 1.0}};

void expect_part(const Vector<2>& a, const Vector<2>& b, double enter, double leave)
{
  const auto part = clip(a, b, kBox);
  ASSERT_TRUE(part);
  EXPECT_DOUBLE_EQ(part->enter, enter);
  EXPECT_DOUBLE_EQ(part->leave, leave);
}

TEST(Clip, KeepsASegmentInside) { expect_part({0.5, 0.5}, {1.5, 0.25}, 0.0, 1.0); }
TEST(Clip, CutsASegmentThatLeaves) { expect_part({1.0, 0.5}, {5.0, 0.5}, 0.0, 0.25); }
TEST(Clip, CutsASegmentThatEnters) { expect_part({5.0, 0.5}, {1.0, 0.5}, 0.75, 1.0); }
TEST(Clip, CutsACornerOff) { expect_part({-0.5, 0.5}, {0.5, 1.5}, 0.5, 0.5); }
TEST(Clip, CutsBothEnds) { expect_part({-1.0, -0.5}, {3.0, 1.5}, 0.25, 0.75); }
TEST(Clip, CountsAnEdgeAsInside) { expect_part({-1.0, 1.0}, {3.0, 1.0}, 0.25, 0.75); }
TEST(Clip, MissesBesideTheBox)
{
  EXPECT_FALSE(clip<2>({-1.0, 1.1}, {3.0, 1.1}, kBox));
  EXPECT_FALSE(clip<2>({-0.6, 0.5}, {0.4, 1.5}, kBox));
  EXPECT_FALSE(clip<2>({3.0, 0.5}, {5.0, 0.5}, kBox));
}
TEST(Clip, WorksInSpace)
{
  const Box<3> box{{0, 0, 0}, {1, 1, 1}};
  const auto part = clip<3>({-1, -1, -1}, {3, 3, 3}, box);
  ASSERT_TRUE(part);
  EXPECT_DOUBLE_EQ(part->enter, 0.25);
  EXPECT_DOUBLE_EQ(part->leave, 0.5);
}
} // namespace
