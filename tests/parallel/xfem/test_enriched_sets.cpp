#include "cut_body.hpp"

#include "pdx/base/gather.hpp"
#include "support/scene.hpp"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <random>

using namespace pdx;
using test::CutBody;
using test::CutBodyOptions;
using xfem::Side;

namespace {
/// An enriched set, or a cut cell, by numbers that do not depend on the ranks: vertex or cell, crack, side.
using Mark = std::array<int, 3>;

struct Picture {
  std::vector<Mark> sets, cells; // side of a cell: -1 not snapped
  Index report_cells = 0, report_sets = 0, dropped = 0;
  std::vector<Vector<2>> closed;
};

Picture picture(const CutBody& body)
{
  Picture p;
  for (Index v = 0; v < body.mesh.owned_vertices(); ++v)
    for (const auto& set : body.sets.of(v))
      p.sets.push_back({body.mesh.natural_vertex(v), set.crack, static_cast<int>(set.side)});
  for (const auto& cut : body.sets.cells())
    if (cut.cell < body.mesh.owned_cells())
      p.cells.push_back(
          {body.mesh.natural_cell(cut.cell), cut.crack, cut.snapped ? static_cast<int>(*cut.snapped) : -1});
  p.sets = gather_all(body.mesh.comm(), p.sets);
  p.cells = gather_all(body.mesh.comm(), p.cells);
  std::ranges::sort(p.sets);
  std::ranges::sort(p.cells);
  const xfem::CutReport& report = body.sets.report();
  p.report_cells = report.cells;
  p.report_sets = report.sets;
  p.dropped = report.dropped;
  p.closed = report.closed;
  return p;
}

void expect_the_same_on_one_rank(const CutBodyOptions& options, const char* what)
{
  SCOPED_TRACE(what);
  const Picture mine = picture(CutBody(options));
  std::vector<int> cells; // some are in pieces
  for (const Mark& mark : mine.cells)
    if (cells.empty() || cells.back() != mark[0]) cells.push_back(mark[0]);
  EXPECT_EQ(mine.report_cells, static_cast<Index>(cells.size()));
  EXPECT_EQ(mine.report_sets, static_cast<Index>(mine.sets.size()));
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank > 0) return;
  const Picture alone = picture(CutBody(options, PETSC_COMM_SELF));
  EXPECT_EQ(mine.sets, alone.sets);
  EXPECT_EQ(mine.cells, alone.cells);
  EXPECT_EQ(mine.dropped, alone.dropped);
  EXPECT_EQ(mine.closed, alone.closed);
}

CutBodyOptions plate(std::vector<crack::Polyline> cracks)
{
  CutBodyOptions options;
  options.cracks = std::move(cracks);
  return options;
}
const std::vector<crack::Polyline> kMiddle{{{0.0, 0.58}, {1.0, 0.58}}}; // through row 3 of 0..5
} // namespace

TEST(EnrichedSets, AreThoseOfOneRank)
{
  expect_the_same_on_one_rank(plate(kMiddle), "straight, across");
  expect_the_same_on_one_rank(plate({{{0.55, 0.0}, {0.55, 1.0}}}), "straight, upwards");
  expect_the_same_on_one_rank(plate({{{0.0, 0.13}, {1.0, 0.91}}}), "slanted");
  expect_the_same_on_one_rank(plate({{{0.0, 0.0}, {1.0, 1.0}}}), "through nodes");
  expect_the_same_on_one_rank(plate({{{0.0, 0.5}, {1.0, 0.5}}}), "along edges");
  expect_the_same_on_one_rank(plate({{{0.0, 0.5}, {0.6, 0.5}}}), "along edges, with a tip");
  expect_the_same_on_one_rank(plate({{{0.0, 0.3}, {0.45, 0.35}, {0.7, 1.0}}}), "kinked");
  expect_the_same_on_one_rank(plate({{{0.21, 0.3}, {0.45, 0.35}, {0.7, 0.6}}}), "kinked, inside");
  expect_the_same_on_one_rank(plate({{{0.0, 0.25}, {1.0, 0.25}}, {{1.0, 0.45}, {0.3, 0.42}}}), "two cracks");
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0.05, 0.95);
  for (int trial = 0; trial < 20; ++trial) {
    CutBodyOptions options = plate({{{0.0, place(random)}, {1.0, place(random)}}});
    if (trial % 2) options.rule.least_share = 0.05; // many are dropped
    if (trial % 4 == 0) options.rule.quadrature = xfem::Quadrature::grid;
    expect_the_same_on_one_rank(options, "random");
  }
}

TEST(EnrichedSets, ACrackThroughARowEnrichesItsTwoLinesOfNodes)
{
  const CutBody body(plate(kMiddle));
  EXPECT_EQ(body.sets.report().cells, 6);
  EXPECT_EQ(body.sets.report().sets, 14);
  EXPECT_EQ(body.sets.report().dropped, 0);
  EXPECT_TRUE(body.sets.report().closed.empty());
  for (Index c = 0; c < body.mesh.cells(); ++c) {
    const bool in_row = std::abs(body.mesh.centroid(c).y() - 3.5 / 6.0) < 0.01;
    EXPECT_EQ(body.mesh.use(c), in_row ? mesh::Use::cut : mesh::Use::plain);
    ASSERT_EQ(body.sets.cut(c) != nullptr, in_row);
    if (!in_row) continue;
    EXPECT_EQ(body.sets.cut(c)->cell, c);
    EXPECT_EQ(body.sets.side_in(*body.sets.cut(c), body.mesh.centroid(c)), Side::plus); // 0.5833 > 0.58
    EXPECT_EQ(body.sets.side_in(*body.sets.cut(c), {0.5, 0.57}), Side::minus);
  }
}

TEST(EnrichedSets, RowsFollowVerticesAndAreKnownToCopies)
{
  const CutBody body(plate({{{0.0, 0.25}, {1.0, 0.25}}, {{0.0, 0.42}, {1.0, 0.42}}})); // neighbouring rows
  PetscInt next = body.rows.first + body.rows.nodes;
  std::vector<int> owner(static_cast<std::size_t>(2 * body.mesh.vertices()), -2);
  for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
    const auto of = body.sets.of(v);
    EXPECT_TRUE(std::ranges::is_sorted(of, {}, &xfem::EnrichedSet::crack));
    for (const auto& set : of) {
      EXPECT_EQ(set.row, next);
      EXPECT_EQ(body.sets.vertices()[static_cast<std::size_t>(next++ - body.rows.first - body.rows.nodes)], v);
      owner[static_cast<std::size_t>(2 * v + set.crack)] = set.row;
    }
  }
  mesh::fill_halo(body.mesh, MPI_INT, 2, owner.data());
  for (Index v = 0; v < body.mesh.vertices(); ++v) {
    int copies = 0;
    for (const auto& set : body.sets.of(v)) {
      EXPECT_EQ(set.row, owner[static_cast<std::size_t>(2 * v + set.crack)]);
      ++copies;
    }
    for (int crack = 0; crack < 2; ++crack) copies -= owner[static_cast<std::size_t>(2 * v + crack)] >= 0;
    EXPECT_EQ(copies, 0);
    if (std::abs(body.mesh.point(v).y() - 2.0 / 6.0) < 0.01) { // the line of nodes between the two rows
      EXPECT_EQ(body.sets.of(v).size(), 2u);
    }
  }
}

TEST(EnrichedSets, ATipInElementsClosesAndIsReportedOnce)
{
  const CutBody body(plate({{{0.0, 0.58}, {0.6, 0.58}}})); // tip in cell 3 of 0..5: two nodes at x = 0.5 are held
  EXPECT_EQ(body.sets.report().cells, 3);
  EXPECT_EQ(body.sets.report().sets, 6);
  EXPECT_EQ(body.sets.report().dropped, 0); // closed is not dropped
  ASSERT_EQ(body.sets.report().closed.size(), 1u);
  EXPECT_EQ(body.sets.report().closed[0], Vector<2>(0.6, 0.58));

  const CutBody inside(plate({{{0.2, 0.58}, {0.8, 0.55}}}));
  EXPECT_EQ(inside.sets.report().closed.size(), 2u);
  const CutBody on_edge(plate({{{0.0, 0.58}, {0.5, 0.58}}}));
  EXPECT_EQ(on_edge.sets.report().closed.size(), 1u);
  EXPECT_EQ(on_edge.sets.report().cells, 3);
  const CutBody short_one(plate({{{0.2, 0.58}, {0.25, 0.59}}})); // inside a cell: it opens nothing, and is reported
  EXPECT_EQ(short_one.sets.report().cells, 0);
  EXPECT_EQ(short_one.sets.report().closed.size(), 2u);
}

TEST(EnrichedSets, ACrackThatRunsOnIntoAPatchIsOpenAtItsBorder)
{
  for (const double end : {1.0, 0.7, 0.55, 0.5}) { // through the patch, tip in it, near its border, on it
    SCOPED_TRACE(end);
    CutBodyOptions options = plate({{{0.0, 0.58}, {end, 0.58}}});
    options.covered = [](const Vector<2>& x) { return x.x() > 0.5 && x.x() < 0.9 && x.y() > 0.3 && x.y() < 0.8; };
    const CutBody body(options);
    EXPECT_EQ(body.sets.report().cells, end == 1.0 ? 4 : 3);
    EXPECT_EQ(body.sets.report().sets, end == 1.0 ? 12 : 8); // both nodes of the edge at x = 0.5 have theirs
    EXPECT_TRUE(body.sets.report().closed.empty());
    for (Index c = 0; c < body.mesh.cells(); ++c) {
      if (body.mesh.use(c) == mesh::Use::covered) {
        EXPECT_EQ(body.sets.cut(c), nullptr);
      }
    }
    expect_the_same_on_one_rank(options, "with a patch");
  }
  CutBodyOptions mirrored = plate({{{1.0, 0.58}, {0.5, 0.58}}}); // from the right, the patch on the left
  mirrored.covered = [](const Vector<2>& x) { return x.x() < 0.5; };
  EXPECT_TRUE(CutBody(mirrored).sets.report().closed.empty());
  EXPECT_EQ(CutBody(mirrored).sets.report().sets, 8);
}

TEST(EnrichedSets, TwoCracksMayCutOneCellButNotBesideAPatch)
{
  const auto message = [](double patch) -> std::string {
    CutBodyOptions options = plate({{{0.0, 0.58}, {1.0, 0.58}}, {{0.0, 0.9}, {1.0, 0.9}}, {{0.58, 0.0}, {0.58, 0.8}}});
    options.covered = [patch](const Vector<2>& x) { return x.x() > patch; };
    try {
      const CutBody body(options);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(0.8), ""); // a row of elements is between
  EXPECT_NE(message(2.0 / 3.0).find("an element that several cracks cut touches a patch at (0.66666"),
            std::string::npos)
      << message(2.0 / 3.0);
}

TEST(EnrichedSets, ACrackThatEndsInAnotherOnesCellClosesBeforeIt)
{
  const CutBody body(plate({{{0.0, 0.58}, {1.0, 0.58}}, {{0.58, 0.0}, {0.58, 0.55}}}));
  EXPECT_EQ(body.sets.report().cells, 6 + 3);
  ASSERT_EQ(body.sets.report().closed.size(), 1u);
  EXPECT_EQ(body.sets.report().closed[0], Vector<2>(0.58, 0.55));
  EXPECT_EQ(body.sets.report().sets, 14 + 6);
}
