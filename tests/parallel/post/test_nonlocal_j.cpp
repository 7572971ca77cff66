#include "pdx/post/nonlocal_j.hpp"
#include "support/bare_patch.hpp"
#include "support/ranks.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

namespace pdx::test::nonlocal_j {
namespace {
const geom::Lattice<2> kLattice{{1.0, 2.0}, 0.25, {23, 21}}; // 5.75 by 5.25 m
const Vector<2> kMiddle(1.0 + 12 * 0.25, 2.0 + 10 * 0.25);

/// Stripes with single sites of others strewn in.
int owner(Index site) { return (site % 23 / 3 + site / 23 / 5 + (site % 11 == 3)) % ranks(); }

Vector<2> wavy(const Vector<2>& x)
{
  return {1e-3 * std::sin(x.x() + 0.3 * x.y()), 2e-3 * std::cos(0.7 * x.x() * x.y())};
}

crack::CrackSet crack_to(const Vector<2>& tip)
{
  return crack::CrackSet({{{1.0, tip.y()}, tip}}, {{1.0, 2.0}, {6.75, 7.25}});
}

std::vector<post::ContourJ> j_of(const test::BarePatch& patch, const test::Field& field, const Vector<2>& direction,
                                 const std::vector<post::SquareContour>& contours)
{
  const std::vector<double> u = patch.displacement(field), w = patch.density(u);
  return post::nonlocal_j({patch.comm, patch.part(), law::Kinematics::small, u, w, 1}, direction, contours);
}

std::string refusal(const post::SquareContour& contour, int margin = 1)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 3.0, owner);
  const std::vector<double> u = patch.displacement(wavy), w = patch.density(u);
  try {
    post::nonlocal_j({patch.comm, patch.part(), law::Kinematics::small, u, w, margin}, Vector<2>::UnitX(),
                     {&contour, 1});
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}
} // namespace

TEST(NonlocalJ, TheSameOnAnyNumberOfRanksWithACrack)
{
  const std::vector<post::SquareContour> contours{{kMiddle, 1.5}, {kMiddle, 3.5}, {kMiddle + Vector<2>(0.5, 0.2), 2.0}};
  const Vector<2> direction = Vector<2>(2.0, 1.0).normalized();
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 4.0, owner), alone(PETSC_COMM_SELF, kLattice, 4.0);
  patch.cut(crack_to(kMiddle));
  alone.cut(crack_to(kMiddle));
  const auto many = j_of(patch, wavy, direction, contours), one = j_of(alone, wavy, direction, contours);
  for (std::size_t c = 0; c < contours.size(); ++c) {
    EXPECT_NE(one[c].j, 0.0);
    EXPECT_NEAR(many[c].j, one[c].j, 1e-10 * std::abs(one[c].j)) << c;
    EXPECT_EQ(many[c].side, one[c].side);
  }
}

TEST(NonlocalJ, VanishesInAUniformStrainWhereFamiliesAreWhole)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 4.0, owner);
  const test::Field field = test::affine(1e-3, 7e-4, 2e-4, -8e-4);
  for (const Vector<2>& direction : {Vector<2>(1.0, 0.0), Vector<2>(0.0, 1.0), Vector<2>(0.6, -0.8)})
    for (const post::ContourJ& found : j_of(patch, field, direction, {{kMiddle, 1.0}, {kMiddle, 2.5}}))
      EXPECT_NEAR(found.j, 0.0, 1e-10 * 3.0 * 1e-6 * found.side); // about W times side
}

// u_x = a x^2 / 2: the stress C11 a x in x balances a body force b = -C11 a, and J = int b . u,x dA. Quadratic fields
// are no trouble to central differences, nor to the lattice's moduli.
TEST(NonlocalJ, OfAFieldWithABodyForceIsTheIntegralOfItsPower)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 3.0, owner);
  const double a = 1e-3, c11 = 3.0 / (1.0 - 1.0 / 9.0);
  const auto field = [&](const Vector<2>& x) { return Vector<2>(0.5 * a * std::pow(x.x(), 2), 0.0); };
  const double found = j_of(patch, field, Vector<2>::UnitX(), {{kMiddle, 3.0}})[0].j;
  EXPECT_NEAR(found, -c11 * a * a * kMiddle.x() * 9.0, 1e-10 * std::abs(found));
}

// Finite bonds, turned far and strained: the formula as a double loop over all pairs, with forces along the deformed
// bonds, and what the product of stretches on the contour is below the mean of W (W itself is left out).
TEST(NonlocalJ, OfFiniteBondsMatchesADoubleLoopOverAllPairs)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 3.0, owner);
  const auto field = [](const Vector<2>& x) {
    return Vector<2>(100.0 * wavy(x) + Vector<2>(-0.6 * x.y(), 0.5 * x.x()));
  };
  const Vector<2> direction(0.6, 0.8);
  const double dx = kLattice.dx;
  const Vector<2> ex(dx, 0.0), ey(0.0, dx);
  const std::vector<double> u = patch.displacement(field), w(static_cast<std::size_t>(patch.rows.owned()), 0.0);
  const post::SquareContour contour{kMiddle, 2.0};
  const double found =
      post::nonlocal_j({patch.comm, patch.part(), law::Kinematics::finite, u, w, 1}, direction, {&contour, 1})[0].j;

  const auto slope = [&](const Vector<2>& x) -> Vector<2> {
    return (0.6 * (field(x + ex) - field(x - ex)) + 0.8 * (field(x + ey) - field(x - ey))) / (2.0 * dx);
  };
  const auto force = [&](const pd::Arm<2>& arm, const Vector<2>& x, const Vector<2>& y) -> Vector<2> {
    const Vector<2> deformed = y + field(y) - x - field(x);
    return arm.kappa * (deformed.norm() / arm.length - 1.0) * deformed.normalized() / 0.5; // per thickness
  };
  const auto excess = [&](const pd::Arm<2>& arm, const Vector<2>& x, const Vector<2>& y, const Vector<2>& step) {
    const Vector<2> df = force(arm, x + step, y + step) - force(arm, x, y);
    return df.dot(field(y + step) - field(x + step) - field(y) + field(x)) / (8.0 * dx);
  };
  const auto inside = [&](const Vector<2>& x) { return (x - kMiddle).lpNorm<Eigen::Infinity>() < 1.0; };
  double expected = 0.0;
  for (Index i = 0; i < kLattice.total(); ++i)
    for (const pd::Arm<2>& arm : patch.part().stencil().half)
      for (const double sign : {1.0, -1.0}) {
        const Vector<2> x = kLattice.point(kLattice.site(i)), y = x + sign * arm.xi;
        if (inside(x) && !inside(y)) expected -= 0.5 * force(arm, x, y).dot(slope(x) + slope(y));
        // the side in front passes between x inside and x + step, the one behind between x and x + step inside
        expected -= 0.6 * (inside(x) - inside(x + ex)) * excess(arm, x, y, ex);
        expected -= 0.8 * (inside(x) - inside(x + ey)) * excess(arm, x, y, ey);
      }
  EXPECT_NEAR(found, expected, 1e-10 * std::abs(expected));
}

// The weight of W alone: W = x without displacement gives the area, as the mean of two columns is the contour's x.
TEST(NonlocalJ, TakesTheMeanOfTheColumnsOnEitherSideForW)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 3.0, owner);
  const std::vector<double> u = patch.displacement(test::affine(0.0, 0.0, 0.0, 0.0));
  std::vector<double> w(static_cast<std::size_t>(patch.rows.first_particle()), 1e6);
  for (std::size_t k = 0; k < patch.part().sites().size(); ++k) w.push_back(patch.point(k).x());
  const post::SquareContour contour{kMiddle, 2.0};
  const post::PatchState state{patch.comm, patch.part(), law::Kinematics::small, u, w, 1};
  EXPECT_NEAR(post::nonlocal_j(state, Vector<2>::UnitX(), {&contour, 1})[0].j, 4.0, 1e-12);
  EXPECT_NEAR(post::nonlocal_j(state, Vector<2>::UnitY(), {&contour, 1})[0].j, 0.0, 1e-12);
}

// A crack through the whole patch, its halves moved apart: derivatives across it must not see the gap.
TEST(NonlocalJ, DifferencesDoNotReachAcrossACrack)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 3.0, owner);
  patch.cut(crack::CrackSet({{{kMiddle.x(), 2.0}, {kMiddle.x(), 7.25}}}, {{1.0, 2.0}, {6.75, 7.25}}));
  const test::Field closed = test::affine(1e-3, 7e-4, 2e-4, -8e-4);
  const auto open = [&](const Vector<2>& x) -> Vector<2> {
    return closed(x) + Vector<2>(x.x() > kMiddle.x() ? 0.1 : 0.0, 0.0);
  };
  const std::vector<post::SquareContour> contours{{kMiddle, 2.0}, {kMiddle + Vector<2>(0.75, 0.0), 1.5}};
  const auto expected = j_of(patch, closed, Vector<2>::UnitX(), contours);
  const auto found = j_of(patch, open, Vector<2>::UnitX(), contours);
  for (std::size_t c = 0; c < contours.size(); ++c)
    EXPECT_NEAR(found[c].j, expected[c].j, 1e-10 * 3.0 * 1e-6 * contours[c].side);
}

TEST(NonlocalJ, ContoursMoveToTheLinesBetweenParticles)
{
  const test::BarePatch patch(PETSC_COMM_WORLD, kLattice, 3.0, owner);
  const auto found = j_of(patch, wavy, Vector<2>::UnitX(), {{kMiddle, 2.0}, {kMiddle, 1.85}, {kMiddle, 1.7}});
  EXPECT_DOUBLE_EQ(found[0].side, 2.0);
  EXPECT_DOUBLE_EQ(found[1].side, 2.0);
  EXPECT_DOUBLE_EQ(found[2].side, 1.5);
  EXPECT_EQ(found[0].j, found[1].j);
  EXPECT_NE(found[0].j, found[2].j);
}

TEST(NonlocalJ, ContoursThatDoNotFitNameTheLargestThatDoes)
{
  EXPECT_EQ(refusal({kMiddle, 4.5}), ""); // 10 rows below the middle, 11 above; 9 and 10 fit
  EXPECT_NE(refusal({kMiddle, 5.0}).find("largest side that fits is 4.5 m"), std::string::npos);
  EXPECT_NE(refusal({kMiddle, 4.0}, 3).find("largest side that fits is 3.5 m"), std::string::npos);
  EXPECT_NE(refusal({kMiddle, 0.1}).find("from 0.25 to 4.5 m"), std::string::npos);
  EXPECT_NE(refusal({{0.0, 0.0}, 1.0}).find("does not fit into the patch"), std::string::npos);
  EXPECT_NE(refusal({kMiddle, std::nan("")}), "");
}

// A patch among elements: bonds that cross its border store their share, and a contour a reach away knows all bonds
// that cross it.
TEST(NonlocalJ, VanishesInAPatchAmongElements)
{
  const test::Option tight("-ksp_rtol", "1e-13");
  test::Scene scene(test::with_patch(test::held_plate({16, 16}), {{0.25, 0.25}, {0.75, 0.75}}, 1.0 / 48));
  const test::Field field = test::affine(1e-3, 7e-4, 2e-4, -8e-4);
  const std::vector<double> u = scene.blocks(field);
  std::vector<double> w = scene.d().bonds->energy_density(u);
  scene.d().carried->add_energy_density(u, w);
  const auto& part = *scene.d().bonds->parts()[0];
  const int reach = part.stencil().reach;
  const post::SquareContour widest{{0.5, 0.5}, 0.5 - 2.0 * reach / 48};
  const auto found =
      post::nonlocal_j({PETSC_COMM_WORLD, part, law::Kinematics::small, u, w, reach}, Vector<2>::UnitX(), {&widest, 1});
  EXPECT_NEAR(found[0].j, 0.0, 1e-10 * 3.0 * 1e-6 * widest.side);
}
} // namespace pdx::test::nonlocal_j
