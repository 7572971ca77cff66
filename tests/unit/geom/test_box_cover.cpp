#include "pdx/geom/box_cover.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace pdx;
using geom::Box;

namespace {
Box<2> box(double x0, double y0, double x1, double y1) { return {{x0, y0}, {x1, y1}}; }

int count_holding(const std::vector<Box<2>>& boxes, const Vector<2>& x)
{
  int count = 0;
  for (const Box<2>& b : boxes) count += b.contains(x);
  return count;
}

/// Middles of the unit cells of [0, 10)^2.
template <class Visit> void for_each_middle(Visit&& visit)
{
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) visit(Vector<2>(i + 0.5, j + 0.5));
}

Box<2> some_box(std::mt19937& random)
{
  std::uniform_int_distribution<int> corner(0, 8);
  const int x = corner(random), y = corner(random);
  return box(x, y, std::uniform_int_distribution<int>(x + 1, 10)(random),
             std::uniform_int_distribution<int>(y + 1, 10)(random));
}
} // namespace

TEST(BoxCover, AHoleLeavesWhatItDoesNotMeet)
{
  EXPECT_EQ(geom::without(box(0, 0, 2, 2), box(2, 0, 4, 2), 1e-6).size(), 1u);         // side by side
  EXPECT_EQ(geom::without(box(0, 0, 2, 2), box(1.9999999, 0, 4, 2), 1e-6).size(), 1u); // to rounding
  EXPECT_EQ(geom::without(box(0, 0, 2, 2), box(-1, -1, 3, 3), 1e-6).size(), 0u);
  EXPECT_EQ(geom::without(box(0, 0, 3, 3), box(1, 1, 2, 2), 1e-6).size(), 4u);
}

TEST(BoxCover, PiecesCoverAllButTheHoleOnce)
{
  std::mt19937 random(7);
  for (int k = 0; k < 200; ++k) {
    const Box<2> whole = some_box(random), hole = some_box(random);
    const auto rest = geom::without(whole, hole, 1e-9);
    for_each_middle([&](const Vector<2>& x) {
      EXPECT_EQ(count_holding(rest, x), whole.contains(x) && !hole.contains(x)) << x.transpose();
    });
  }
}

TEST(BoxCover, JoinedBoxesCoverTheSameOnce)
{
  std::mt19937 random(3);
  for (int k = 0; k < 100; ++k) {
    std::vector<Box<2>> cells;
    for_each_middle([&](const Vector<2>& x) {
      if (random() % 3) cells.push_back(box(x[0] - 0.5, x[1] - 0.5, x[0] + 0.5, x[1] + 0.5));
    });
    const auto few = geom::joined(cells, 1e-9);
    EXPECT_LT(few.size(), cells.size());
    for_each_middle([&](const Vector<2>& x) { EXPECT_EQ(count_holding(few, x), count_holding(cells, x)); });
  }
  EXPECT_EQ(geom::joined({box(0, 0, 1, 1), box(1, 1, 2, 2), box(1, 0, 2, 1), box(0, 1, 1, 2)}, 1e-9).size(), 1u);
}
