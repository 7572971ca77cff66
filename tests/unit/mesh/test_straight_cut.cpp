#include "pdx/mesh/straight_cut.hpp"

#include <gtest/gtest.h>
#include <numeric>
#include <random>

using namespace pdx;

namespace {
struct Cells {
  std::vector<Vector<2>> middle;
  std::vector<int> weight;

  Cells(int nx, int ny, double h)
  {
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) middle.emplace_back((x + 0.5) * h, (y + 0.5) * h);
    weight.assign(middle.size(), 1);
  }
  mesh::PlacedCells placed() const { return {middle, weight}; }
  std::vector<int> weights_of(const std::vector<int>& part, int parts) const
  {
    std::vector<int> sums(static_cast<std::size_t>(parts), 0);
    for (std::size_t c = 0; c < part.size(); ++c) sums[static_cast<std::size_t>(part[c])] += weight[c];
    return sums;
  }
};
} // namespace

TEST(StraightCut, HalvesTheLongerSide)
{
  const Cells cells(40, 10, 1e-4);
  const std::vector<int> part = mesh::straight_cut(cells.placed(), 2);
  for (std::size_t c = 0; c < part.size(); ++c) EXPECT_EQ(part[c], cells.middle[c][0] < 20e-4 ? 0 : 1);
  EXPECT_DOUBLE_EQ(mesh::busiest_window(cells.placed(), part, 2), 210.0); // and a column of the other's
}

TEST(StraightCut, PartsAnyNumberEvenly)
{
  const Cells cells(60, 42, 1.0);
  for (const int parts : {3, 5, 6, 7, 12}) {
    const std::vector<int> sums = cells.weights_of(mesh::straight_cut(cells.placed(), parts), parts);
    for (const int sum : sums) EXPECT_NEAR(sum, 60.0 * 42.0 / parts, 0.08 * 60.0 * 42.0 / parts) << parts;
  }
}

TEST(StraightCut, FollowsTheWeights)
{
  Cells cells(40, 8, 1.0);
  for (std::size_t c = 0; c < cells.weight.size(); ++c)
    if (cells.middle[c][0] < 10.0) cells.weight[c] = 9; // 720 of 960: half are in 53 columns' worth of 80
  const std::vector<int> sums = cells.weights_of(mesh::straight_cut(cells.placed(), 2), 2);
  EXPECT_NEAR(sums[0], sums[1], 72.0); // a column
}

TEST(StraightCut, IsTheSameInAnyOrderOfCells)
{
  const Cells cells(30, 30, 0.3);
  const std::vector<int> part = mesh::straight_cut(cells.placed(), 4);
  std::vector<std::size_t> order(part.size());
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  Cells shuffled = cells;
  for (std::size_t k = 0; k < order.size(); ++k) shuffled.middle[k] = cells.middle[order[k]];
  const std::vector<int> other = mesh::straight_cut(shuffled.placed(), 4);
  for (std::size_t k = 0; k < order.size(); ++k) EXPECT_EQ(other[k], part[order[k]]);
}

TEST(StraightCut, AJaggedBorderHasTheWiderWindow)
{
  const Cells cells(40, 10, 1.0);
  std::vector<int> straight = mesh::straight_cut(cells.placed(), 2), jagged = straight;
  for (std::size_t c = 0; c < jagged.size(); ++c) { // as even: a tooth each way
    if (cells.middle[c][0] > 17.0 && cells.middle[c][0] < 20.0 && cells.middle[c][1] < 5.0) jagged[c] = 1;
    if (cells.middle[c][0] > 20.0 && cells.middle[c][0] < 23.0 && cells.middle[c][1] > 5.0) jagged[c] = 0;
  }
  EXPECT_DOUBLE_EQ(mesh::busiest_window(cells.placed(), jagged, 2), 240.0);
  EXPECT_LT(mesh::busiest_window(cells.placed(), straight, 2), 240.0);
}
