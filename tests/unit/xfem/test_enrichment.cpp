#include "cut_plate.hpp"
#include "pdx/base/symmetric.hpp"

#include <algorithm>
#include <gtest/gtest.h>

using namespace pdx;
using xfem::Side;
using xfem::Verdict;

namespace {
const Tensor<2> kSheared{{1.0, 0.3}, {0.1, 0.9}};

std::vector<Index> nodes_of(const std::vector<xfem::NodeSupport>& supports)
{
  std::vector<Index> nodes;
  for (const auto& support : supports) nodes.push_back(support.node);
  return nodes;
}

struct Spectrum {
  int rigid;        ///< modes without stiffness
  double condition; ///< of the others
};
Spectrum spectrum(const Eigen::MatrixXd& k)
{
  const Eigen::VectorXd value = symmetric_eigenvalues(k);
  const double largest = value[value.size() - 1];
  const int rigid = static_cast<int>(std::ranges::count_if(value, [&](double v) { return v < 1e-12 * largest; }));
  return {rigid, largest / value[rigid]};
}
/// Scaled to a diagonal of ones, as a Jacobi preconditioner does.
Eigen::MatrixXd scaled(const Eigen::MatrixXd& k)
{
  const Eigen::VectorXd scale = k.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * k * scale.asDiagonal();
}
} // namespace

TEST(Enrichment, CrackThroughAMiddleRowEnrichesTheNodesOfThatRow)
{
  CutPlate plate(3, 1.0);
  plate.cut({{0.0, 1.5}, 0.0});
  EXPECT_EQ(plate.cuts.size(), 3u);
  EXPECT_EQ(nodes_of(plate.enrichment.nodes), (std::vector<Index>{4, 5, 6, 7, 8, 9, 10, 11}));
  EXPECT_TRUE(plate.enrichment.dropped.empty());
  const auto& inner = plate.enrichment.nodes[1]; // node 5 at (1, 1): two cells below, two cut in the middle
  EXPECT_EQ(inner.side, Side::minus);
  EXPECT_NEAR(inner.area[Side::plus], 1.0, 1e-15);
  EXPECT_NEAR(inner.area[Side::minus], 3.0, 1e-15);
}

TEST(Enrichment, SupportsCountNeighboursThatAreNotCut)
{
  CutPlate plate(2, 1.0);
  plate.cut({{0.5, 0.0}, -std::numbers::pi / 4.0}); // cuts the corner cell along x + y = 0.5
  ASSERT_EQ(plate.cuts.size(), 1u);
  ASSERT_EQ(nodes_of(plate.enrichment.nodes), (std::vector<Index>{0, 1, 3, 4}));
  const auto& nodes = plate.enrichment.nodes;
  EXPECT_NEAR(nodes[0].area[Side::minus], 0.125, 1e-15);
  EXPECT_NEAR(nodes[0].area[Side::plus], 0.875, 1e-15);
  EXPECT_NEAR(nodes[1].area[Side::plus], 1.875, 1e-15);
  EXPECT_NEAR(nodes[3].area[Side::plus], 3.875, 1e-15);
}

TEST(Enrichment, CrackAlongAnEdgeOpensThroughTheNodesOnIt)
{
  CutPlate plate(2, 1.0);
  plate.cut({{0.0, 1.0}, 0.0}); // nodes at y = 1 are on the plus side: the cells below are cut, with no area above
  EXPECT_EQ(plate.cuts.size(), 2u);
  EXPECT_EQ(nodes_of(plate.enrichment.nodes), (std::vector<Index>{3, 4, 5}));
  EXPECT_EQ(nodes_of(plate.enrichment.dropped), (std::vector<Index>{0, 1, 2}));
  for (const auto& snapped : plate.enrichment.snapped) EXPECT_EQ(snapped, Side::minus);
  EXPECT_EQ(spectrum(plate.rest_tangent()).rigid, 6);
}

TEST(Enrichment, TipClosesAtTheLastCutEdge)
{
  CutPlate plate(4, 1.0);
  plate.cut({{0.0, 1.5}, 0.0}, [](Index cell) { return cell % 4 < 2; }); // from the left rim to x = 2
  EXPECT_EQ(nodes_of(plate.enrichment.nodes), (std::vector<Index>{5, 6, 10, 11}));
  EXPECT_EQ(nodes_of(plate.enrichment.dropped), (std::vector<Index>{7, 12}));
  for (const auto& held : plate.enrichment.dropped) EXPECT_EQ(held.verdict, Verdict::tip);
  EXPECT_EQ(spectrum(plate.rest_tangent()).rigid, 3);
}

TEST(Enrichment, CrackThatEntersAPatchStaysOpenAtItsBorder)
{
  CutPlate plate(4, 1.0);
  std::erase_if(plate.active, [](Index cell) { return cell % 4 >= 2; }); // the right half is under a patch
  plate.cut({{0.0, 1.5}, 0.0});
  EXPECT_EQ(nodes_of(plate.enrichment.nodes), (std::vector<Index>{5, 6, 7, 10, 11, 12}));
  EXPECT_TRUE(plate.enrichment.dropped.empty());
}

TEST(Enrichment, EachCrackHasItsOwnSets)
{
  CutPlate plate(5, 1.0);
  plate.cut({{0.0, 0.5}, 0.0});
  const auto lower = plate.cuts;
  plate.cut({{0.0, 1.5}, 0.0}); // the row above shares nodes 6 to 11 with it
  for (auto& cut : plate.cuts) cut.crack = 1;
  plate.cuts.insert(plate.cuts.begin(), lower.begin(), lower.end());
  const auto both = xfem::enrich(plate.view(), plate.cuts);
  ASSERT_EQ(both.nodes.size(), 24u);
  EXPECT_EQ(both.nodes[11].crack, 0);
  EXPECT_EQ(both.nodes[11].node, 11);
  EXPECT_EQ(both.nodes[12].crack, 1);
  EXPECT_EQ(both.nodes[12].node, 6);
  EXPECT_EQ(xfem::sets_of(plate.view(), plate.cuts[5], both), (std::array<Index, 4>{12, 13, 19, 18}));
  EXPECT_EQ(xfem::cell_of_two_cracks(plate.cuts), std::nullopt);
  plate.cuts.push_back({2, 1, {}});
  EXPECT_EQ(xfem::cell_of_two_cracks(plate.cuts), 2);
}

TEST(Enrichment, ShareBelowTheToleranceIsDroppedAndItsSliverMovesToTheOtherHalf)
{
  // The line through (1 + a, 1) and (1, 1 + a) cuts the corner (1, 1) off the middle cell: area a^2 / 2. All that the
  // node at (2, 2) with its support of 4 has on that side is this corner: share a^2 / 8.
  for (const double share : {0.9e-4, 1.1e-4}) {
    CutPlate plate(3, 1.0);
    const double a = std::sqrt(8.0 * share);
    plate.cut({{1.0 + a, 1.0}, 3.0 * std::numbers::pi / 4.0});
    const bool kept = share > 1e-4;
    const auto far = std::ranges::find(plate.enrichment.dropped, plate.node(2, 2), &xfem::NodeSupport::node);
    EXPECT_EQ(far == plate.enrichment.dropped.end(), kept);
    EXPECT_EQ(std::ranges::count_if(plate.enrichment.snapped, [](const auto& s) { return s.has_value(); }),
              kept ? 0 : 1);
    if (far == plate.enrichment.dropped.end()) continue;
    EXPECT_EQ(far->verdict, Verdict::share);
    EXPECT_EQ(far->lean, far->side);
  }
}

TEST(Enrichment, PlateCutThroughAtTwoHundredRandomLinesMovesAsTwoRigidHalves)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.5, 5.5), angle(0.0, 2.0 * std::numbers::pi);
  int moved = 0;
  for (int trial = 0; trial < 200; ++trial) {
    CutPlate plate(6, 0.01, trial % 2 ? kSheared : Tensor<2>::Identity());
    plate.kinematics = trial % 4 < 2 ? law::Kinematics::small : law::Kinematics::finite;
    const Line line{0.01 * Vector<2>(place(random), place(random)), angle(random)};
    plate.cut(line);
    moved += static_cast<int>(plate.enrichment.dropped.size());
    const auto rigid = [&](const Vector<2>& x, Side side) -> Vector<2> {
      const double turn = side == Side::plus ? 0.3 : -0.2;
      const Vector<2> shift = step(side) * Vector<2>(0.01, -0.02);
      if (plate.kinematics == law::Kinematics::small) return shift + turn * Vector<2>(-x.y(), x.x());
      const Vector<2> turned(std::cos(turn) * x.x() - std::sin(turn) * x.y(),
                             std::sin(turn) * x.x() + std::cos(turn) * x.y());
      return shift + turned - x;
    };
    const auto force = plate.force(plate.unknowns_of(line, rigid));
    EXPECT_LT(force.norm(), 1e-12 * plate.kYoung * plate.kThickness * 0.02) << trial;
  }
  EXPECT_GT(moved, 0); // some of the lines do graze a node
}

TEST(Enrichment, UniaxialStressAlongTheCrackOfItsOwnSizeInEachHalfIsInBalance)
{
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(1.0, 5.0), angle(0.0, 2.0 * std::numbers::pi);
  int tried = 0;
  for (int trial = 0; trial < 100; ++trial) {
    CutPlate plate(6, 0.01, trial % 2 ? kSheared : Tensor<2>::Identity());
    const Line line{0.01 * Vector<2>(place(random), place(random)), angle(random)};
    plate.cut(line);
    if (!plate.enrichment.dropped.empty()) continue; // exact where nothing was moved
    ++tried;
    const Vector<2> t = line.along(), n(-t.y(), t.x());
    const Tensor<2> strain = t * t.transpose() - 0.3 * n * n.transpose();
    const auto pulled = [&](const Vector<2>& x, Side side) -> Vector<2> {
      return (side == Side::plus ? 2e-3 : -1e-3) * (strain * x) + step(side) * 1e-4 * n;
    };
    Eigen::VectorXd force = plate.force(plate.unknowns_of(line, pulled));
    const double scale = force.norm();
    const auto on_rim = [&](Index v) { return v % 7 == 0 || v % 7 == 6 || v < 7 || v >= 42; };
    for (Index v = 0; v < 49; ++v)
      if (on_rim(v)) force.segment<2>(2 * v).setZero();
    for (std::size_t s = 0; s < plate.enrichment.nodes.size(); ++s)
      if (on_rim(plate.enrichment.nodes[s].node)) force.segment<2>(static_cast<Eigen::Index>(2 * (49 + s))).setZero();
    EXPECT_LT(force.norm(), 1e-12 * scale) << trial;
    EXPECT_GT(scale, 0.1 * plate.kYoung * 1e-3 * 0.01 * plate.kThickness);
  }
  EXPECT_GT(tried, 50);
}

TEST(Enrichment, ConditionStaysBoundedAsTheCrackApproachesANode)
{
  // Unscaled it grows up to about 1 / tolerance^2 = 1e8; scaled to a diagonal of ones it does not grow.
  for (const double angle : {0.0, 0.5, std::numbers::pi / 4.0, 2.0})
    for (const double side : {1.0, -1.0})
      for (int digits = 1; digits <= 14; ++digits) {
        CutPlate plate(4, 1.0);
        const double gap = side * std::pow(10.0, -digits);
        const Vector<2> normal(-std::sin(angle), std::cos(angle));
        plate.cut({Vector<2>(2.0, 2.0) + gap * normal, angle});
        const Eigen::MatrixXd k = plate.rest_tangent();
        EXPECT_EQ(spectrum(k).rigid, 6) << angle << ' ' << gap;
        EXPECT_LT(spectrum(k).condition, 1e8) << angle << ' ' << gap;
        EXPECT_LT(spectrum(scaled(k)).condition, 200.0) << angle << ' ' << gap;
      }
}

TEST(Enrichment, CornerOfThePlateIsCutOffUntilItIsTooSmallToBeAPieceOfItsOwn)
{
  for (int digits = 1; digits <= 14; ++digits) {
    CutPlate plate(4, 1.0);
    const double gap = std::pow(10.0, -digits);
    plate.cut({{gap, 0.0}, 3.0 * std::numbers::pi / 4.0}); // the corner node's own share is gap^2 / 2
    const bool is_piece = gap * gap / 2.0 > 1e-4;
    const Eigen::MatrixXd k = plate.rest_tangent();
    EXPECT_EQ(plate.enrichment.nodes.empty(), !is_piece);
    EXPECT_EQ(spectrum(scaled(k)).rigid, is_piece ? 6 : 3) << gap;
    EXPECT_LT(spectrum(scaled(k)).condition, 1e5) << gap;
  }
}

TEST(Enrichment, GridQuadratureLeavesNoUnknownWithoutStiffnessEither)
{
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(1.0, 3.0), angle(0.0, 2.0 * std::numbers::pi);
  for (int trial = 0; trial < 200; ++trial) {
    CutPlate plate(4, 1.0);
    plate.rule.quadrature = trial % 2 ? xfem::Quadrature::grid : xfem::Quadrature::polygons;
    const Line line{{place(random), place(random)}, angle(random)};
    plate.cut(line);
    const Spectrum s = spectrum(scaled(plate.rest_tangent()));
    EXPECT_EQ(s.rigid, 6) << trial;
    EXPECT_LT(s.condition, 1e5) << trial;
  }
}

TEST(Enrichment, CrackInACellTenThousandTimesSmallerThanItsNeighboursIsClosed)
{
  CutPlate plate(3, 1.0);
  for (Vector<2>& x : plate.points)
    if (x.x() > 1.5) x.x() -= 1.0 - 1e-5; // the middle column is 1e-5 wide
  plate.cut({{1.0 + 0.4e-5, 0.0}, std::numbers::pi / 2.0});
  EXPECT_TRUE(plate.enrichment.nodes.empty());
  for (const auto& snapped : plate.enrichment.snapped) EXPECT_EQ(snapped, Side::minus); // 0.6 of the column, right
  EXPECT_EQ(spectrum(plate.rest_tangent()).rigid, 3);
}
