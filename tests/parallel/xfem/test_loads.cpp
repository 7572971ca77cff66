#include "cut_body.hpp"

#include "pdx/io/snapshot.hpp"
#include "pdx/xfem/cut_output.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>
#include <set>

using namespace pdx;
using test::CutBody;
using test::CutBodyOptions;
using xfem::Side;

namespace {
CutBodyOptions cut_plate(double left, double right)
{
  CutBodyOptions options;
  options.cracks = {{{0.0, left}, {1.0, right}}};
  return options;
}
const Vector<2> kTraction(3.0, -2.0); // [Pa]
constexpr double kThickness = 0.2;

/// Linear on either side, with a jump.
Vector<2> jumping(const Vector<2>& x, Side side)
{
  if (side == Side::plus) return {0.1 + 0.5 * x.y(), 0.2 * x.x()};
  return {-0.3 * x.y(), 0.4 - 0.1 * x.y()};
}

/// Force on nodes alone: the total.
Vector<2> total(const CutBody& body)
{
  Vector<2> sum = Vector<2>::Zero();
  for (PetscInt k = 0; k < 2 * body.rows.nodes; ++k) sum[k % 2] += body.load[static_cast<std::size_t>(k)];
  return {body.sum(sum.x()), body.sum(sum.y())};
}
} // namespace

TEST(EnrichedLoads, WorkOfATractionOnAJumpIsTheIntegralOverBothPartsOfTheSide)
{
  for (const double at : {0.58, 0.3, 0.5, 0.66}) { // 0.5 is on a node
    CutBody body(cut_plate(0.21, at));
    fem::add_traction(body.mesh, *body.mesh.boundary("right"), kTraction, kThickness, body.loads());
    xfem::add_traction(body.mesh, body.sets, *body.mesh.boundary("right"), kTraction, kThickness, body.loads());
    EXPECT_LT((total(body) - kThickness * kTraction).norm(), 1e-14);
    // On x = 1: u = (-0.3 y, 0.4 - 0.1 y) below the crack, (0.1 + 0.5 y, 0.2) above it.
    const double half = 0.5 * at * at, rest = 0.5 - half;
    const double below = 3.0 * (-0.3 * half) - 2.0 * (0.4 * at - 0.1 * half);
    const double above = 3.0 * (0.1 * (1.0 - at) + 0.5 * rest) - 2.0 * 0.2 * (1.0 - at);
    const double work = body.dot(body.load, body.owned_blocks(jumping));
    EXPECT_NEAR(work, kThickness * (below + above), at == 0.5 ? 1e-9 : 1e-14) << at;
  }
}

TEST(EnrichedLoads, WithoutAnOpeningTheTractionIsThatOfPlainElements)
{
  CutBody body(cut_plate(0.21, 0.58));
  const CutBody whole{CutBodyOptions{}};
  std::vector<double> plain(static_cast<std::size_t>(2 * whole.rows.owned()), 0.0);
  fem::add_traction(whole.mesh, *whole.mesh.boundary("right"), kTraction, kThickness,
                    {whole.node_rows, whole.rows, plain});
  fem::add_traction(body.mesh, *body.mesh.boundary("right"), kTraction, kThickness, body.loads());
  xfem::add_traction(body.mesh, body.sets, *body.mesh.boundary("right"), kTraction, kThickness, body.loads());
  ASSERT_EQ(whole.rows.nodes, body.rows.nodes);
  for (std::size_t k = 0; k < plain.size(); ++k) EXPECT_NEAR(body.load[k], plain[k], 1e-15);
}

TEST(EnrichedLoads, WorkOfABodyForceOnAJumpIsTheIntegralOverBothHalves)
{
  const auto gravity = [](const Vector<2>& x) -> Vector<2> { return {1.0 + x.x(), -2.0}; }; // [N/m^3]
  CutBody body(cut_plate(0.58, 0.58));
  fem::add_body_force(body.mesh, gravity, kThickness, body.loads());
  xfem::add_body_force(body.mesh, body.sets, gravity, kThickness, body.loads());
  EXPECT_LT((total(body) - kThickness * Vector<2>(1.5, -2.0)).norm(), 1e-14);
  // int (1 + x) u_x - 2 u_y, x from 0 to 1, below and above y = 0.58
  const double at = 0.58, half = 0.5 * at * at, rest = 0.5 - half;
  const double below = 1.5 * (-0.3 * half) - 2.0 * (0.4 * at - 0.1 * half);
  const double above = 1.5 * (0.1 * (1.0 - at) + 0.5 * rest) - 2.0 * 0.1 * (1.0 - at);
  EXPECT_NEAR(body.dot(body.load, body.owned_blocks(jumping)), kThickness * (below + above), 1e-14);
}

TEST(CutOutput, PolygonsCarryTheFieldOfTheirSideAndFillTheCutCells)
{
  for (const double right : {0.58, 0.9}) {
    CutBody body(cut_plate(0.21, right));
    const auto u = body.local(body.owned_blocks(jumping));
    const field::OutputBlock block = xfem::cut_block(body.mesh, body.sets, body.node_rows, *body.halo, u);
    EXPECT_EQ(block.name, "cut_cells");
    ASSERT_EQ(block.fields.size(), 2u);
    const auto &displacement = block.fields[0].values, &side = block.fields[1].values;
    const std::size_t points = block.natural_point.size();
    ASSERT_EQ(displacement.size(), 3 * points);
    ASSERT_EQ(side.size(), points);
    EXPECT_EQ(std::set<int>(block.natural_point.begin(), block.natural_point.end()).size(), points);
    for (std::size_t k = 0; k < points; ++k) {
      const Vector<2> x(block.points[3 * k], block.points[3 * k + 1]);
      const Vector<2> expected = jumping(x, side[k] > 0.0 ? Side::plus : Side::minus);
      EXPECT_LT((Vector<2>(displacement[3 * k], displacement[3 * k + 1]) - expected).norm(), 1e-13);
    }
    const PetscInt first = field::Rows::number(body.mesh.comm(), 1, static_cast<Index>(points), 0, 0).first;
    double area = 0.0;
    for (std::size_t c = 0; c < block.cells.size(); c += 4)
      for (std::size_t k = 0; k < 4; ++k) { // shoelace
        const auto a = static_cast<std::size_t>(3 * (block.cells[c + k] - first));
        const auto b = static_cast<std::size_t>(3 * (block.cells[c + (k + 1) % 4] - first));
        ASSERT_LT(std::max(a, b) + 2, block.points.size());
        area += 0.5 * (block.points[a] * block.points[b + 1] - block.points[b] * block.points[a + 1]);
      }
    EXPECT_NEAR(body.sum(area), body.sets.report().cells / 36.0, 1e-13);
    const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
    io::FieldsFile file(PETSC_COMM_WORLD, scratch.path());
    EXPECT_NO_THROW(file.write(0.0, {{block}}));
  }
}
