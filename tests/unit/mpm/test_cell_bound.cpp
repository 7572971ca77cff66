#include "pdx/mpm/cell_bound.hpp"

#include <gtest/gtest.h>

using namespace pdx;

// Sites of a cell are numbered along x first.
TEST(PointsAtFaces, SeesWhatIsNextToEachPart)
{
  const auto full = mpm::points_at_faces<2>(2, 0b1111);
  for (const auto parts : full) EXPECT_EQ(parts, 0b11);
  const auto lower_right = mpm::points_at_faces<2>(2, 0b0010);
  EXPECT_EQ(lower_right[0], 0b00); // x low
  EXPECT_EQ(lower_right[1], 0b01); // x high, its lower part
  EXPECT_EQ(lower_right[2], 0b10); // y low, its right part
  EXPECT_EQ(lower_right[3], 0b00);
  for (const auto parts : mpm::points_at_faces<2>(3, 1ULL << 4)) EXPECT_EQ(parts, 0); // the middle of nine
}

TEST(PointsAtFaces, SeesThemInSpace)
{
  const auto corner = mpm::points_at_faces<3>(2, 1ULL << 7); // x, y and z high
  for (const std::size_t low : {0u, 2u, 4u}) {
    EXPECT_EQ(corner[low], 0);
    EXPECT_EQ(corner[low + 1], 0b1000);
  }
  for (const auto parts : mpm::points_at_faces<3>(2, 0xff)) EXPECT_EQ(parts, 0b1111);
}
