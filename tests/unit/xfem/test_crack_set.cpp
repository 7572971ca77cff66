#include "cut_plate.hpp"
#include "pdx/base/symmetric.hpp"
#include "pdx/crack/cut_cells.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// Cuts a plate by what the crack set finds.
crack::Cuts cut(CutPlate& plate, const crack::Polyline& line)
{
  const geom::Box<2> body{Vector<2>::Zero(), Vector<2>::Constant(plate.n * plate.h)};
  const auto found = crack::find_cuts(crack::CrackSet({line}, body), 0, {plate.points, plate.cells}, 1e-9 * plate.h);
  plate.cuts.clear();
  for (const auto& cell : found.cells) {
    if (cell.kind != crack::CellKind::through) continue;
    xfem::CellCut& cut = plate.cuts.emplace_back(xfem::CellCut{cell.cell, 0, {}});
    for (std::size_t a = 0; a < 4; ++a) {
      const Index v = plate.cells[static_cast<std::size_t>(cell.cell)][a];
      cut.distance[a] = found.distance[static_cast<std::size_t>(v)];
    }
  }
  plate.enrichment = xfem::enrich(plate.view(), plate.cuts, plate.rule);
  return found;
}
} // namespace

TEST(EnrichmentByACrackSet, NodesOfCutCellsAreEnrichedSaveWhereTheCrackClosesOrASliverMoves)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(0.3, 5.7);
  int closed = 0;
  for (int trial = 0; trial < 300; ++trial) {
    CutPlate plate(6, 1.0);
    crack::Polyline line{{place(random), place(random)}, {place(random), place(random)}};
    const auto found = cut(plate, line);
    std::vector<Index> tips, all;
    for (const auto& node : plate.enrichment.nodes) all.push_back(node.node);
    for (const auto& node : plate.enrichment.dropped) {
      all.push_back(node.node);
      if (node.verdict == xfem::Verdict::tip) tips.push_back(node.node);
    }
    std::ranges::sort(all);
    std::vector<Index> closing = found.closing;
    std::erase_if(closing, [&](Index v) { return !std::ranges::binary_search(all, v); });
    EXPECT_EQ(all, found.points) << trial;
    EXPECT_EQ(tips, closing) << trial;
    closed += static_cast<int>(tips.size());
  }
  EXPECT_GT(closed, 300);
}

TEST(EnrichmentByACrackSet, CrackWithAKinkInACellPartsThePlateInTwo)
{
  std::mt19937 random(12);
  std::uniform_real_distribution<double> place(0.8, 4.2);
  for (int trial = 0; trial < 100; ++trial) {
    CutPlate plate(5, 1.0);
    cut(plate, {{0.0, place(random)}, {place(random), place(random)}, {5.0, place(random)}});
    const Eigen::VectorXd modes = symmetric_eigenvalues(plate.rest_tangent());
    const double least = 1e-12 * modes.maxCoeff();
    EXPECT_EQ((modes.array() < least).count(), 6) << trial;
  }
}
