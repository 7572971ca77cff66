// Where cracks meet: each body of a plate that they cut has displacements of its own, whatever runs through one cell.
#include "pieced_plate.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using namespace pdx::xfem;

namespace {
constexpr double kFar = 10.0; // beyond any plate here [m]

/// Straight half-lines from one place.
struct Rays {
  Vector<2> middle;
  std::vector<double> angles;

  Vector<2> along(std::size_t k) const { return {std::cos(angles[k]), std::sin(angles[k])}; }
};

/// Three cracks that meet, or one with a branch where it bends.
std::vector<crack::Polyline> lines_of(const Rays& star, bool bent)
{
  const auto out = [&](std::size_t k) { return Vector<2>(star.middle + kFar * star.along(k)); };
  if (bent) return {{out(0), star.middle, out(1)}, {out(2), star.middle}};
  return {{out(0), star.middle}, {out(1), star.middle}, {out(2), star.middle}};
}

const Rays kY{{0.52, 0.49}, {-2.4, 0.3, 2.0}};
} // namespace

TEST(Pieces, AYInOneCellHasTwelveFunctionsAndNineRigidMotions)
{
  for (const bool bent : {false, true}) {
    const PiecedPlate cell(1, lines_of(kY, bent));
    ASSERT_EQ(cell.pieces.cells.size(), 1u);
    EXPECT_EQ(cell.pieces.cells[0].pieces.size(), 3u);
    EXPECT_EQ(cell.rows(), 12); // 4 nodes, a copy of each in each of 3 pieces
    EXPECT_EQ(zeros(cell.stiffness()), 9);
    const PiecedPlate plate(3, lines_of(kY, bent));
    EXPECT_EQ(zeros(plate.stiffness()), 9);
  }
}

TEST(Pieces, TwelveFunctionsAreIndependent)
{
  const PiecedPlate cell(1, lines_of(kY, false));
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(cell.rows(), cell.rows());
  cell.for_each_element([&](const EnrichedElement& element, const std::vector<int>& at) {
    for (const PartPoint& point : element.cell.points(Side::plus)) {
      Eigen::VectorXd values = Eigen::VectorXd::Zero(cell.rows());
      std::size_t set = 4;
      for (std::size_t a = 0; a < 4; ++a) {
        values[at[a]] += point.shape[static_cast<Index>(a)];
        if (element.enriched[a])
          values[at[set++]] += element.factor(a, Side::plus) * point.shape[static_cast<Index>(a)];
      }
      gram += point.area * values * values.transpose();
    }
  });
  EXPECT_EQ(zeros(gram), 0); // rank 12 in each direction
}

TEST(Pieces, ConditionStaysBoundedNearNodesAndEdges)
{
  for (const double away : {1e-1, 1e-2, 1e-3, 1e-5, 1e-7, 1e-10, 0.0}) {
    const Vector<2> corner(1.0 / 3.0, 1.0 / 3.0);
    for (const bool diagonal : {false, true}) {
      const Vector<2> middle = corner + Vector<2>(away, diagonal ? away : 0.12);
      const PiecedPlate plate(3, {{{-1.0, middle.y()}, {2.0, middle.y()}}, {{middle.x(), -1.0}, {middle.x(), 2.0}}});
      const Eigen::VectorXd values = symmetric_eigenvalues(plate.stiffness());
      const int free = zeros(plate.stiffness());
      EXPECT_EQ(free, 12) << away; // four bodies
      EXPECT_LT(values[values.size() - 1] / values[free], 1e7) << away;
    }
  }
}

TEST(Pieces, CracksAlongOneEdgeAndManyInOneCell)
{
  // Two that cross one edge, and three lines through one cell: bodies in a row, and seven of three lines.
  const PiecedPlate rows(3, {{{-1.0, 0.45}, {2.0, 0.45}}, {{-1.0, 0.52}, {2.0, 0.56}}});
  EXPECT_EQ(zeros(rows.stiffness()), 9);
  const PiecedPlate seven(3, {{{-1.0, 0.4}, {2.0, 0.4}}, {{-0.345, -1.0}, {1.31, 2.0}}, {{1.345, -1.0}, {-0.31, 2.0}}});
  EXPECT_EQ(seven.pieces.cells[4].pieces.size(), 7u);
  EXPECT_EQ(zeros(seven.stiffness()), 21);
}
