#include "cut_body.hpp"
#include "support/frequencies.hpp"

#include <gtest/gtest.h>

namespace pdx::test::lumped_mass {
namespace {
constexpr double kDensity = 3.0, kThickness = 0.2;

struct Cut {
  Vector<2> point;
  double angle;
};

test::CutBodyOptions body_cut_at(const Cut& cut)
{
  const Vector<2> along(std::cos(cut.angle), std::sin(cut.angle));
  test::CutBodyOptions options;
  options.cracks = {{cut.point - 3.0 * along, cut.point + 3.0 * along}};
  options.law.density = kDensity;
  return options;
}

/// Area of the unit square on the plus side.
double area_above(const Cut& cut)
{
  const fem::Corners corners{Vector<2>(0.0, 0.0), Vector<2>(1.0, 0.0), Vector<2>(1.0, 1.0), Vector<2>(0.0, 1.0)};
  xfem::CornerDistances distance;
  for (std::size_t a = 0; a < 4; ++a)
    distance[a] = (corners[a] - cut.point).dot(Vector<2>(-std::sin(cut.angle), std::cos(cut.angle)));
  return xfem::side_areas(corners, distance, xfem::Quadrature::polygons)[xfem::Side::plus];
}

/// Momentum and kinetic energy of the whole body when one half moves and the other rests.
struct Motion {
  Vector<2> momentum = Vector<2>::Zero();
  double energy = 0.0;
};

Motion motion(const test::CutBody& body, xfem::Side moving, const Vector<2>& velocity)
{
  std::vector<double> v = body.owned_blocks(
      [&](const Vector<2>&, xfem::Side side) -> Vector<2> { return side == moving ? velocity : 0.0 * velocity; });
  std::vector<double> mass(static_cast<std::size_t>(body.rows.owned()), 0.0);
  std::vector<field::Tie> ties;
  for (const auto& term : body.terms) {
    term->add_mass(mass);
    term->ties(ties);
  }
  EXPECT_EQ(static_cast<Index>(ties.size()), body.rows.enriched);
  test::to_tied(ties, v);
  Motion sum;
  for (std::size_t row = 0; row < mass.size(); ++row) {
    const Vector<2> own(v[2 * row], v[2 * row + 1]);
    sum.momentum += mass[row] * own;
    sum.energy += 0.5 * mass[row] * own.squaredNorm();
  }
  return {{body.sum(sum.momentum.x()), body.sum(sum.momentum.y())}, body.sum(sum.energy)};
}

TEST(LumpedMass, GivesEitherHalfItsMomentumAndKineticEnergy)
{
  const Vector<2> velocity(1.3, -0.7);
  for (const Cut& cut : {Cut{{0.5, 0.45}, 0.0}, Cut{{0.5, 0.5 + 1e-3}, 0.0}, Cut{{0.5, 0.5 - 1e-3}, 0.0},
                         Cut{{0.53, 0.47}, 0.3}, Cut{{0.45, 0.52}, 0.8}, Cut{{0.3, 0.4}, 2.2}}) {
    const test::CutBody body(body_cut_at(cut));
    ASSERT_EQ(body.sets.report().dropped, 0);
    for (const xfem::Side side : xfem::kSides) {
      const double share = side == xfem::Side::plus ? area_above(cut) : 1.0 - area_above(cut);
      const double mass = kDensity * kThickness * share;
      const Motion found = motion(body, side, velocity);
      EXPECT_NEAR((found.momentum - mass * velocity).norm(), 0.0, 1e-13 * mass) << cut.point.transpose();
      EXPECT_NEAR(found.energy, 0.5 * mass * velocity.squaredNorm(), 1e-13 * mass) << cut.point.transpose();
    }
  }
}

TEST(LumpedMass, IsCompleteWhereRowsWereDropped)
{
  const Vector<2> velocity(1.0, 0.0);
  for (const double gap : {1e-5, 1e-9, 1e-14}) {
    const Cut cut{{0.5, 0.5 + gap}, 0.0};
    const test::CutBody body(body_cut_at(cut));
    EXPECT_GT(body.sets.report().dropped, 0);
    const double above = motion(body, xfem::Side::plus, velocity).momentum.x();
    const double below = motion(body, xfem::Side::minus, velocity).momentum.x();
    EXPECT_NEAR(above + below, kDensity * kThickness, 1e-13);
    EXPECT_NEAR(above, kDensity * kThickness * area_above(cut), 1e-4 * kDensity * kThickness);
  }
}

TEST(LumpedMass, OfElementsThatAreNoParallelogramsIsComplete)
{
  test::CutBodyOptions options = body_cut_at({{0.5, 0.45}, 0.3});
  options.grid.moved = test::zigzag(options.grid.box, options.grid.cells, 0.2);
  const test::CutBody body(options);
  std::vector<double> mass(static_cast<std::size_t>(body.rows.owned()), 0.0);
  for (const auto& term : body.terms) term->add_mass(mass);
  double total = 0.0;
  for (const double m : mass) total += m;
  EXPECT_NEAR(body.sum(total), kDensity * kThickness, 1e-13);
}
} // namespace
} // namespace pdx::test::lumped_mass
