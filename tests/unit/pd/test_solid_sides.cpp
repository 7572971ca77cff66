#include "pdx/pd/solid_sides.hpp"
#include "pdx/pd/surface.hpp"

#include <cmath>
#include <gtest/gtest.h>

// Plates and bars of a lattice, their bonds summed up one by one. Figures of bars are those of an independent program
// (a prototype in another language), to the digits given.
namespace pdx::solid_sides_test {
using Aim = pd::SolidSides::Aim;
constexpr double kDx = 2.5e-3;
const law::Elastic kElastic{70e9, 0.25, law::Plane::strain, 1.0, 2500.0};

pd::Stencil<3> stencil(double ratio, law::Micromodulus micromodulus = law::Micromodulus::conical)
{
  return pd::make_stencil<3>({kDx, 1.0, ratio * kDx, micromodulus, pd::Calibration::lattice, kElastic});
}

/// A lattice of rows [0, count) in directions with a count, endless in others.
pd::BondFactors<3> factors(const pd::Stencil<3>& bonds, Aim aim, const Site<3>& count)
{
  Site<3> lower{}, extent{1, 1, 1};
  for (std::size_t d = 0; d < 3; ++d)
    if (count[d]) extent[d] = count[d];
  const auto exists = [count](const Site<3>& site) {
    for (std::size_t d = 0; d < 3; ++d)
      if (count[d] && (site[d] < 0 || site[d] >= count[d])) return false;
    return true;
  };
  const geom::Lattice<3> lattice{Vector<3>::Zero(), bonds.dx, extent};
  return pd::correct_sides(bonds, *pd::SolidSides::solve(bonds, aim), exists, nullptr)({lattice, lower, extent});
}

template <class Visit>
void for_each_bond(const pd::Stencil<3>& bonds, const Site<3>& count, const pd::BondFactors<3>& of, Visit&& visit)
{
  Site<3> site{};
  for (site[2] = 0; site[2] < std::max(1, count[2]); ++site[2])
    for (site[1] = 0; site[1] < std::max(1, count[1]); ++site[1])
      for (std::size_t h = 0; h < bonds.half.size(); ++h) {
        Site<3> to = site;
        bool there = true;
        for (std::size_t d = 1; d < 3; ++d) {
          to[d] += bonds.half[h].step[d];
          there = there && (!count[d] || (to[d] >= 0 && to[d] < count[d]));
        }
        if (there) visit(site, bonds.half[h], of.of(site, h));
      }
}

/// Energies of uniform strain per volume over the solid's, sum of kappa xi n_a^2 n_b^2.
Tensor<3> moduli(const pd::Stencil<3>& bonds, const Site<3>& count, const pd::BondFactors<3>& of)
{
  Tensor<3> sum = Tensor<3>::Zero();
  for_each_bond(bonds, count, of, [&](const Site<3>&, const pd::Arm<3>& arm, double w) {
    const Vector<3> squares = (arm.xi / arm.length).array().square();
    sum += w * arm.kappa * arm.length * squares * squares.transpose();
  });
  const pd::LatticeModuli bulk = pd::lattice_moduli(bonds);
  const double volume = bonds.volume() * std::max(1, count[1]) * std::max(1, count[2]);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) sum(a, b) /= volume * (a == b ? bulk.c11 : bulk.c12);
  return sum;
}

// All uniform strains of a plate have the energy of the solid.
TEST(SolidSides, PlatesAreAsStiffAsTheirMaterial)
{
  for (const double ratio : {3.015, 4.015})
    for (const Aim aim : {Aim::bending, Aim::traction}) {
      const pd::Stencil<3> bonds = stencil(ratio);
      for (const Index layers : {5, 6, 8, 9, 12, 30}) {
        const Site<3> count{0, 0, layers};
        const Tensor<3> stiff = moduli(bonds, count, factors(bonds, aim, count));
        EXPECT_LT((stiff.array() - 1.0).abs().maxCoeff(), 1e-9) << ratio << ", " << layers << " layers\n" << stiff;
      }
    }
}

// A plate that is pulled and sheared along its sides, and free to contract, is at rest: no force on any layer.
TEST(SolidSides, WhatIsFreeIsAtRest)
{
  const pd::Stencil<3> bonds = stencil(3.015);
  const Tensor<3> strain = Vector<3>(0.7, 0.2, -0.9 / 3.0).asDiagonal();
  for (const Index layers : {4, 7, 40}) {
    const Site<3> count{0, 0, layers};
    std::vector<Vector<3>> force(static_cast<std::size_t>(layers), Vector<3>::Zero());
    double size = 0.0;
    for_each_bond(bonds, count, factors(bonds, Aim::traction, count),
                  [&](const Site<3>& from, const pd::Arm<3>& arm, double w) {
                    const Vector<3> n = arm.xi / arm.length, f = w * arm.kappa * n.dot(strain * n) * n;
                    force[static_cast<std::size_t>(from[2])] += f;
                    force[static_cast<std::size_t>(from[2] + arm.step[2])] -= f;
                    size = std::max(size, f.norm());
                  });
    for (const Vector<3>& f : force) EXPECT_LT(f.norm(), 1e-11 * size) << layers;
  }
}

/// Zeroth and first moment of the tension that passes a plane across the side, over those of a uniform one, from the
/// side to the depth of 40 layers; at rest, stretched along the tension and across it.
TEST(SolidSides, BesidePointsTractionIsWhereItShouldBe)
{
  for (const double ratio : {3.015, 4.015}) {
    const pd::Stencil<3> bonds = stencil(ratio);
    const Site<3> count{0, 0, 80};
    const pd::BondFactors<3> of = factors(bonds, Aim::traction, count);
    for (const Vector<3>& strain : {Vector<3>(1, 0, -1.0 / 3.0), Vector<3>(0, 1, -1.0 / 3.0)}) {
      double force = 0.0, moment = 0.0, bulk = 0.0;
      const auto pull = [&](const pd::Arm<3>& arm) {
        const Vector<3> n = arm.xi / arm.length;
        return arm.kappa * n.cwiseAbs2().dot(strain) * n[0];
      };
      for (const pd::Arm<3>& arm : bonds.half) bulk += arm.step[0] * pull(arm);
      for_each_bond(bonds, count, of, [&](const Site<3>& from, const pd::Arm<3>& arm, double w) {
        const int crossings = std::abs(arm.step[0]), sign = arm.step[0] < 0 ? -1 : 1;
        for (int j = 0; j < crossings; ++j) {
          const double z = from[2] + 0.5 + arm.step[2] * (j + 0.5) / crossings;
          if (z > 40.0 + 1e-9) continue;
          const double part = (z > 40.0 - 1e-9 ? 0.5 : 1.0) * sign * w * pull(arm);
          force += part;
          moment += z * part;
        }
      });
      EXPECT_NEAR(force / bulk, 40.0, 1e-8) << ratio;
      EXPECT_NEAR(moment / bulk, 800.0, 1e-7) << ratio;
    }
  }
}

// Where sides meet there is no exact answer: the prototype's product.
TEST(SolidSides, BarsAreNearlyAsStiffAsTheirMaterial)
{
  const pd::Stencil<3> bonds = stencil(3.015);
  const struct {
    Index rows;
    double along, young; // sum of n_x^4; E
  } bars[] = {{3, 1.1190, 1.1213}, {4, 1.0047, 1.0061}, {5, 1.0023, 1.0030}, {6, 1.0013, 1.0017}};
  const auto sides = pd::SolidSides::solve(bonds, Aim::bending);
  for (const auto& bar : bars) {
    const Site<3> count{0, bar.rows, bar.rows};
    EXPECT_NEAR(moduli(bonds, count, factors(bonds, Aim::bending, count))(0, 0), bar.along, 1e-4) << bar.rows;
    EXPECT_NEAR(pd::bar_tension(bonds, &*sides, {bar.rows, bar.rows}), bar.young, 1e-4) << bar.rows;
  }
}

TEST(SolidSides, StayWithinTheirBounds)
{
  for (const law::Micromodulus micromodulus : {law::Micromodulus::conical, law::Micromodulus::uniform})
    for (const double ratio : {3.0, 3.015, 4.0, 5.0}) {
      if (micromodulus == law::Micromodulus::uniform && ratio > 4.0) continue; // more bonds than words hold
      const pd::Stencil<3> bonds = stencil(ratio, micromodulus);
      for (const Aim aim : {Aim::bending, Aim::traction}) {
        const auto sides = pd::SolidSides::solve(bonds, aim);
        ASSERT_TRUE(sides) << ratio;
        for (int row = 0; row < sides->rows(); ++row)
          for (const pd::Arm<3>& arm : bonds.half) {
            EXPECT_GE(sides->at(row, arm.step, 2), 0.2);
            EXPECT_LE(sides->at(row, arm.step, 2), 3.0);
            EXPECT_EQ(sides->at(row, arm.step, 2), sides->at(row, {arm.step[2], arm.step[1], arm.step[0]}, 0));
          }
      }
    }
}
} // namespace pdx::solid_sides_test
