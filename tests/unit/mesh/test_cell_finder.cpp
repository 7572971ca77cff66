#include "pdx/mesh/cell_finder.hpp"

#include <algorithm>
#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// 7 x 5 cells, 2 wide and 1 high, from (-3, 1) on.
struct Plate {
  std::vector<std::array<Index, 4>> cells;
  std::vector<Vector<2>> points;
  Plate()
  {
    for (Index j = 0; j <= 5; ++j)
      for (Index i = 0; i <= 7; ++i) points.emplace_back(-3.0 + 2.0 * i, 1.0 + j);
    for (Index j = 0; j < 5; ++j)
      for (Index i = 0; i < 7; ++i) cells.push_back({8 * j + i, 8 * j + i + 1, 8 * j + i + 9, 8 * j + i + 8});
  }
};
} // namespace

TEST(CellFinder, FindsCellsByTheirMiddle)
{
  const Plate plate;
  const mesh::CellFinder finder(plate.cells, plate.points);
  EXPECT_EQ(finder.in({{-1.0, 2.0}, {3.0, 4.0}}), (std::vector<Index>{8, 9, 15, 16}));
  EXPECT_EQ(finder.in({{-2.0, 1.5}, {-2.0, 1.5}}), (std::vector<Index>{0})); // on the border
  EXPECT_TRUE(finder.in({{20.0, 20.0}, {30.0, 30.0}}).empty());
  EXPECT_EQ(finder.in({{-100.0, -100.0}, {100.0, 100.0}}).size(), 35u);
}

TEST(CellFinder, FindsCellsAtVerticesAndAroundBoxes)
{
  const Plate plate;
  const mesh::CellFinder finder(plate.cells, plate.points);
  const std::span<const Index> inside = finder.at(9), corner = finder.at(0);
  EXPECT_EQ(std::vector<Index>(inside.begin(), inside.end()), (std::vector<Index>{0, 1, 7, 8}));
  EXPECT_EQ(std::vector<Index>(corner.begin(), corner.end()), (std::vector<Index>{0}));
  EXPECT_EQ(finder.at_any(std::vector<Index>{0, 9}), (std::vector<Index>{0, 1, 7, 8}));
  const geom::Box<2> point{{-1.0, 2.0}, {-1.0, 2.0}}; // of four cells
  const std::vector<Index> around = finder.around({&point, 1});
  for (const Index c : {0, 1, 7, 8}) EXPECT_TRUE(std::ranges::binary_search(around, c));
  EXPECT_LT(around.size(), 20u);
}
