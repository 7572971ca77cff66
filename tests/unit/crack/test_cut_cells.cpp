#include "pdx/crack/cut_cells.hpp"

#include <gtest/gtest.h>
#include <map>
#include <random>

namespace {
using namespace pdx;
using crack::CellKind;
using crack::CrackSet;
using crack::Cuts;

/// A grid of n x n square cells on [0, size]^2; cell (i, j) is number j n + i, point (i, j) number j (n + 1) + i.
struct Grid {
  Index n;
  double size;
  std::vector<Vector<2>> points;
  std::vector<std::array<Index, 4>> cells;
  Grid(Index count, double side) : n(count), size(side)
  {
    for (Index j = 0; j <= n; ++j)
      for (Index i = 0; i <= n; ++i) points.emplace_back(size * i / n, size * j / n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        cells.push_back({point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)});
  }
  Index point(Index i, Index j) const { return j * (n + 1) + i; }
  Index cell(Index i, Index j) const { return j * n + i; }
  geom::Box<2> body() const { return {{0.0, 0.0}, {size, size}}; }
  Cuts cut(const crack::Polyline& line, double tolerance = 1e-8) const
  {
    return crack::find_cuts(CrackSet({line}, body()), 0, {points, cells}, tolerance);
  }
};

using Kinds = std::map<Index, CellKind>;
Kinds kinds(const Cuts& cuts)
{
  Kinds found;
  for (const auto& cut : cuts.cells) found[cut.cell] = cut.kind;
  return found;
}

TEST(CutCells, ACrackThroughARowCutsItAndNothingElse)
{
  const Grid grid(5, 5.0);
  const Cuts cuts = grid.cut({{0.0, 2.5}, {5.0, 2.5}});
  ASSERT_EQ(cuts.cells.size(), 5u);
  for (Index i = 0; i < 5; ++i) {
    EXPECT_EQ(cuts.cells[i].cell, grid.cell(i, 2));
    EXPECT_EQ(cuts.cells[i].kind, CellKind::through);
    EXPECT_EQ(cuts.cells[i].edges, 0b1010); // right and left
  }
  std::vector<Index> expected;
  for (const Index j : {2, 3})
    for (Index i = 0; i <= 5; ++i) expected.push_back(grid.point(i, j));
  EXPECT_EQ(cuts.points, expected);
  EXPECT_TRUE(cuts.closing.empty());
  EXPECT_DOUBLE_EQ(cuts.distance[grid.point(0, 0)], -2.5);
  EXPECT_DOUBLE_EQ(cuts.distance[grid.point(3, 3)], 0.5);
}

// Part I, section 4: a crack of half the width in 33 x 33 cells ends in the middle of cell 17 of row 17.
TEST(CutCells, TheCellWithTheTipIsNotCutThrough)
{
  const Grid grid(33, 0.1);
  const Cuts cuts = grid.cut({{0.0, 0.05}, {0.05, 0.05}});
  ASSERT_EQ(cuts.cells.size(), 17u);
  for (Index i = 0; i < 17; ++i) {
    EXPECT_EQ(cuts.cells[i].cell, grid.cell(i, 16));
    EXPECT_EQ(cuts.cells[i].kind, i < 16 ? CellKind::through : CellKind::tip);
  }
  EXPECT_EQ(cuts.points.size(), 34u);
  EXPECT_EQ(cuts.closing, (std::vector<Index>{grid.point(16, 16), grid.point(16, 17)}));
}

TEST(CutCells, ATipOnAnEdgeClosesThere)
{
  const Grid grid(5, 5.0);
  for (const double x : {3.0, 3.0 - 5e-9, 3.0 + 5e-9}) {
    const Cuts cuts = grid.cut({{0.0, 2.5}, {x, 2.5}});
    const CellKind through = CellKind::through;
    EXPECT_EQ(kinds(cuts), (Kinds{{10, through}, {11, through}, {12, through}, {13, CellKind::tip}})) << x;
    EXPECT_EQ(cuts.closing, (std::vector<Index>{grid.point(3, 2), grid.point(3, 3)}));
  }
  EXPECT_EQ(kinds(grid.cut({{0.0, 2.5}, {3.0 - 1e-6, 2.5}}))[12], CellKind::tip);
}

TEST(CutCells, AlongEdgesItCutsTheCellsToItsRight)
{
  const Grid grid(4, 4.0);
  for (const double y : {2.0, 2.0 + 0.9e-8, 2.0 - 0.9e-8}) {
    const Cuts cuts = grid.cut({{0.0, y}, {4.0, y}});
    ASSERT_EQ(cuts.cells.size(), 4u) << y;
    for (Index i = 0; i < 4; ++i) EXPECT_EQ(cuts.cells[i].cell, grid.cell(i, 1)); // below
    EXPECT_EQ(cuts.distance[grid.point(2, 2)], 1e-8);
    const Cuts back = grid.cut({{4.0, y}, {0.0, y}});
    ASSERT_EQ(back.cells.size(), 4u);
    for (Index i = 0; i < 4; ++i) EXPECT_EQ(back.cells[i].cell, grid.cell(i, 2)); // above is right of this one
  }
  EXPECT_EQ(grid.cut({{0.0, 2.0 + 2e-8}, {4.0, 2.0 + 2e-8}}).cells[0].cell, grid.cell(0, 2));
}

TEST(CutCells, AlongEdgesToAPointItEndsThere)
{
  const Grid grid(4, 4.0);
  const Cuts cuts = grid.cut({{0.0, 2.0}, {2.0, 2.0}});
  EXPECT_EQ(kinds(cuts), (Kinds{{4, CellKind::through}, {5, CellKind::through}, {6, CellKind::tip}}));
  EXPECT_EQ(cuts.closing, (std::vector<Index>{grid.point(2, 1), grid.point(2, 2)}));
}

// The diagonal runs through points (k, k), which are seen on its left (above): it cuts the cells on the diagonal and
// the corners of those below it that lie at these points.
TEST(CutCells, ThroughPointsItPassesThemOnItsRight)
{
  const Grid grid(4, 4.0);
  for (const double off : {0.0, 1e-9, -1e-9}) {
    const Cuts cuts = grid.cut({{0.0, off}, {4.0, 4.0 + off}});
    Kinds expected;
    for (Index k = 0; k < 4; ++k) expected[grid.cell(k, k)] = CellKind::through;
    for (Index k = 1; k < 4; ++k) expected[grid.cell(k, k - 1)] = CellKind::through;
    EXPECT_EQ(kinds(cuts), expected) << off;
    for (Index k = 0; k <= 4; ++k) EXPECT_EQ(cuts.distance[grid.point(k, k)], 1e-8);
  }
}

TEST(CutCells, AShortCrackInsideACellIsATip)
{
  const Grid grid(4, 4.0);
  EXPECT_EQ(kinds(grid.cut({{1.2, 1.3}, {1.7, 1.6}})), (Kinds{{grid.cell(1, 1), CellKind::tip}}));
}

TEST(CutCells, AnInternalCrackHasTwoTipCells)
{
  const Grid grid(5, 5.0);
  const Cuts cuts = grid.cut({{0.5, 2.5}, {3.5, 2.5}});
  const CellKind through = CellKind::through, tip = CellKind::tip;
  EXPECT_EQ(kinds(cuts), (Kinds{{10, tip}, {11, through}, {12, through}, {13, tip}}));
  EXPECT_EQ(cuts.closing.size(), 4u);
}

TEST(CutCells, FollowsABentCrack)
{
  const Grid grid(4, 4.0);
  const Cuts cuts = grid.cut({{0.0, 0.5}, {1.5, 0.5}, {1.5, 4.0}}); // right, then up through column 1
  EXPECT_EQ(kinds(cuts), (Kinds{{0, CellKind::through},
                                {1, CellKind::through},
                                {5, CellKind::through},
                                {9, CellKind::through},
                                {13, CellKind::through}}));
}

TEST(CutCells, AStraightCrackThroughTheBodyCutsWhatHasCornersOnBothSides)
{
  const Grid grid(7, 1.0);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    const Vector<2> middle(0.5 + 0.4 * uniform(random), 0.5 + 0.4 * uniform(random));
    const Vector<2> along = Vector<2>(uniform(random), uniform(random)).normalized();
    const Cuts cuts = grid.cut({middle - 3.0 * along, middle + 3.0 * along});
    Kinds expected;
    for (std::size_t c = 0; c < grid.cells.size(); ++c) {
      int left = 0;
      for (const Index p : grid.cells[c]) {
        const Vector<2> d = grid.points[p] - middle;
        left += along.x() * d.y() - along.y() * d.x() > 0.0;
      }
      if (left % 4) expected[static_cast<Index>(c)] = CellKind::through;
    }
    EXPECT_EQ(kinds(cuts), expected);
  }
}
} // namespace
