#include "pdx/base/error.hpp"
#include "pdx/pd/stencil.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace pdx::test::stencil {
namespace {
using law::Micromodulus;
using pd::Calibration;
constexpr double kDx = 2.5e-5, kYoung = 192e9;

template <int Dim>
pd::StencilOptions options(double ratio, Micromodulus micromodulus, Calibration calibration,
                           law::Plane plane = law::Plane::stress)
{
  const law::Elastic elastic{kYoung, law::required_poisson(Dim, plane), plane, 2e-3};
  return {kDx, 2e-3, ratio * kDx, micromodulus, calibration, elastic};
}

/// Energy density of one particle of an endless lattice under a uniform strain, bond by bond in both directions.
template <int Dim> double energy_density(const pd::Stencil<Dim>& stencil, const Tensor<Dim>& strain)
{
  const double volume = Dim == 2 ? kDx * kDx * stencil.thickness : kDx * kDx * kDx;
  double energy = 0.0;
  for (const auto& arm : stencil.half)
    for (const int sign : {1, -1}) {
      Vector<Dim> xi;
      for (int d = 0; d < Dim; ++d) xi[d] = sign * arm.step[d] * kDx;
      const double stretch = (strain * xi).dot(xi) / xi.squaredNorm();
      energy += 0.25 * arm.kappa * stretch * stretch * xi.norm() / volume;
    }
  return energy;
}

/// Second differences of the energy, which is quadratic: exact with strains of 1.
template <int Dim> pd::LatticeModuli moduli_from_energy(const pd::Stencil<Dim>& stencil)
{
  Tensor<Dim> x = Tensor<Dim>::Zero(), y = x, shear = x;
  x(0, 0) = y(1, 1) = 1.0;
  shear(0, 1) = shear(1, 0) = 0.5;
  const double wx = energy_density<Dim>(stencil, x), wy = energy_density<Dim>(stencil, y);
  return {2.0 * wx, energy_density<Dim>(stencil, x + y) - wx - wy, 2.0 * energy_density<Dim>(stencil, shear)};
}

template <int Dim> void expect_exact_moduli(double ratio, Micromodulus micromodulus, law::Plane plane)
{
  const auto o = options<Dim>(ratio, micromodulus, Calibration::lattice, plane);
  const pd::Stencil<Dim> stencil = pd::make_stencil<Dim>(o);
  const law::Elastic target{kYoung, o.elastic.poisson, Dim == 3 ? law::Plane::strain : plane, 1.0};
  const pd::LatticeModuli m = moduli_from_energy(stencil), summed = pd::lattice_moduli(stencil);
  EXPECT_NEAR(m.c11 / target.c11(), 1.0, 1e-12) << ratio;
  EXPECT_NEAR(m.c12 / target.c12(), 1.0, 1e-12) << ratio;
  EXPECT_NEAR(m.c66 / target.mu(), 1.0, 1e-12) << ratio;
  EXPECT_NEAR(summed.c11 / m.c11, 1.0, 1e-12);
  EXPECT_NEAR(summed.c12 / m.c12, 1.0, 1e-12);
  EXPECT_NEAR(summed.c66 / m.c66, 1.0, 1e-12);
}

TEST(Stencil, LatticeCalibrationGivesTheSolidsModuli)
{
  for (const auto shape : {Micromodulus::conical, Micromodulus::uniform})
    for (const double ratio : {3.0, 3.015, 4.0, 6.0}) {
      expect_exact_moduli<2>(ratio, shape, law::Plane::stress);
      expect_exact_moduli<2>(ratio, shape, law::Plane::strain);
    }
  for (const double ratio : {3.0, 3.015, 4.0}) expect_exact_moduli<3>(ratio, Micromodulus::conical, law::Plane::strain);
  expect_exact_moduli<3>(3.015, Micromodulus::uniform, law::Plane::strain);
}

struct TableRow {
  Micromodulus micromodulus;
  double ratio, c11, c12, toughness;
};
/// Independent reference numbers: moduli over the solid's, and lattice toughness over the given one.
const TableRow kTable[] = {
    {Micromodulus::conical, 3.0, .9567, .8969, .9069},    {Micromodulus::conical, 3.015, .9553, .8978, .9060},
    {Micromodulus::conical, 4.0, .9810, .9606, .9585},    {Micromodulus::conical, 6.0, .9915, .9835, .9796},
    {Micromodulus::uniform, 3.0, 1.0327, .9825, 1.0342},  {Micromodulus::uniform, 3.015, 1.0307, .9786, 1.0304},
    {Micromodulus::uniform, 4.0, 1.0158, 1.0037, 1.0210}, {Micromodulus::uniform, 6.0, 1.0080, .9996, 1.0091}};

TEST(Stencil, ContinuumConstantsMissTheModuliByKnownAmounts)
{
  for (const TableRow& row : kTable) {
    const auto o = options<2>(row.ratio, row.micromodulus, Calibration::continuum);
    const pd::LatticeModuli m = moduli_from_energy(pd::make_stencil<2>(o));
    EXPECT_NEAR(m.c11 / o.elastic.c11(), row.c11, 5.1e-5) << row.ratio;
    EXPECT_NEAR(m.c12 / o.elastic.c12(), row.c12, 5.1e-5) << row.ratio;
    EXPECT_NEAR(m.c66, m.c12, 1e-12 * m.c12);
  }
}

TEST(Stencil, ToughnessOfARowCrackIsOffByKnownAmounts)
{
  for (const TableRow& row : kTable) {
    const auto o = options<2>(row.ratio, row.micromodulus, Calibration::continuum);
    const law::BondLaw<2> bond(row.micromodulus, o.elastic, o.horizon);
    EXPECT_NEAR(pd::lattice_toughness(pd::make_stencil<2>(o), bond.critical_stretch(135.0)) / 135.0, row.toughness,
                5.1e-5)
        << row.ratio;
  }
}

void expect_weights(double ratio, Micromodulus micromodulus, double lowest, double highest, double tolerance)
{
  const auto plain = pd::make_stencil<2>(options<2>(ratio, micromodulus, Calibration::continuum));
  const auto exact = pd::make_stencil<2>(options<2>(ratio, micromodulus, Calibration::lattice));
  ASSERT_EQ(plain.half.size(), exact.half.size());
  double least = 1e9, most = 0.0;
  for (std::size_t h = 0; h < plain.half.size(); ++h) {
    const double gamma = exact.half[h].kappa / plain.half[h].kappa;
    least = std::min(least, gamma);
    most = std::max(most, gamma);
  }
  EXPECT_NEAR(least, lowest, tolerance) << ratio;
  EXPECT_NEAR(most, highest, tolerance) << ratio;
}

TEST(Stencil, WeightsStayNearOne)
{
  expect_weights(4.0, Micromodulus::conical, .998, 1.052, 5.1e-4);
  expect_weights(3.0, Micromodulus::conical, .991, 1.139, 5.1e-4);
  expect_weights(3.0, Micromodulus::uniform, .92, 1.045, 5.1e-3);
  expect_weights(3.015, Micromodulus::uniform, .92, 1.051, 5.1e-3);
  expect_weights(4.0, Micromodulus::uniform, .97, 1.004, 5.1e-3);
}

TEST(Stencil, HoldsEveryBondOnce)
{
  const auto stencil = pd::make_stencil<2>(options<2>(3.0, Micromodulus::conical, Calibration::lattice));
  // 28 sites lie within 3 dx; the 4 on the horizon have volume but no stiffness.
  EXPECT_EQ(stencil.half.size(), 12u);
  EXPECT_EQ(stencil.mute.size(), 2u);
  EXPECT_EQ(stencil.reach, 2);
  for (const auto& arm : stencil.half) {
    EXPECT_TRUE(arm.step[1] > 0 || (arm.step[1] == 0 && arm.step[0] > 0));
    for (const auto& other : stencil.half) EXPECT_FALSE(arm.step[0] == -other.step[0] && arm.step[1] == -other.step[1]);
    EXPECT_NEAR(arm.length, kDx * std::hypot(arm.step[0], arm.step[1]), 1e-15 * kDx);
    EXPECT_NEAR((arm.xi - kDx * Vector<2>(arm.step[0], arm.step[1])).norm(), 0.0, 1e-15 * kDx);
  }
  for (const auto& arm : stencil.mute) EXPECT_EQ(arm.kappa, 0.0);
}

TEST(Stencil, KappaIsConstantTimesShareTimesVolumes)
{
  const auto o = options<2>(3.0, Micromodulus::uniform, Calibration::continuum);
  const auto stencil = pd::make_stencil<2>(o);
  const double c = law::BondLaw<2>(o.micromodulus, o.elastic, o.horizon).constant(0.0), volume = kDx * kDx * 2e-3;
  for (const auto& arm : stencil.half) {
    const double beta = std::clamp(3.5 - std::hypot(arm.step[0], arm.step[1]), 0.0, 1.0);
    EXPECT_NEAR(arm.volume_share, beta, 1e-12);
    EXPECT_NEAR(arm.kappa / (c * beta * volume * volume), 1.0, 1e-12);
  }
}

TEST(Stencil, FamilyVolumeCountsBothHalvesAndTheHorizon)
{
  const double volume = kDx * kDx * 2e-3;
  // conical m = 3 by number of sites and distance: 4 at 1, sqrt2, 2; 8 at sqrt5; 4 at sqrt8 (beta 3.5 - sqrt8), 3 (1/2)
  const auto conical = pd::make_stencil<2>(options<2>(3.0, Micromodulus::conical, Calibration::lattice));
  const double inner = 20.0 + 4.0 * (3.5 - std::sqrt(8.0)) + 4.0 * 0.5;
  EXPECT_NEAR(conical.family_volume_full() / volume, inner, 1e-10);
  // uniform: also 8 at sqrt10; those at 3.5 and beyond have no share
  const auto uniform = pd::make_stencil<2>(options<2>(3.0, Micromodulus::uniform, Calibration::lattice));
  EXPECT_NEAR(uniform.family_volume_full() / volume, inner + 8.0 * (3.5 - std::sqrt(10.0)), 1e-10);
}

TEST(Stencil, RefusesHorizonsItCannotServe)
{
  const auto lattice = Calibration::lattice;
  EXPECT_THROW(pd::make_stencil<2>(options<2>(0.5, Micromodulus::conical, lattice)), UserError);
  EXPECT_THROW(pd::make_stencil<2>(options<2>(1.2, Micromodulus::conical, lattice)), UserError); // only shell: 1
  EXPECT_THROW(pd::make_stencil<2>(options<2>(20.5, Micromodulus::conical, lattice)), UserError);
  try {
    pd::make_stencil<2>(options<2>(1.2, Micromodulus::conical, lattice));
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("horizon of 1.2 times"), std::string::npos) << error.what();
  }
}

TEST(Stencil, KnowsWhatBondWordsHold)
{
  const auto lattice = Calibration::lattice;
  EXPECT_NO_THROW(pd::require_bond_words(pd::make_stencil<2>(options<2>(8.0, Micromodulus::conical, lattice))));
  EXPECT_NO_THROW(pd::require_bond_words(pd::make_stencil<3>(options<3>(4.0, Micromodulus::conical, lattice))));
  const auto wide = pd::make_stencil<3>(options<3>(6.0, Micromodulus::conical, lattice));
  EXPECT_EQ(wide.half.size(), 447u); // of the 925 lattice points within 6 dx, 30 are at 6 dx and one is the particle
  EXPECT_THROW(pd::require_bond_words(wide), UserError);
  try {
    pd::require_bond_words(pd::make_stencil<2>(options<2>(12.0, Micromodulus::conical, lattice)));
    ADD_FAILURE() << "not refused";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("horizon too wide"), std::string::npos) << error.what();
  }
}

TEST(Stencil, NeverHasAWeightThatIsNotPositive)
{
  for (int k = 0; k < 140; ++k)
    for (const auto shape : {Micromodulus::conical, Micromodulus::uniform}) {
      const double ratio = 1.0 + 0.05 * k;
      try {
        const auto stencil = pd::make_stencil<2>(options<2>(ratio, shape, Calibration::lattice));
        for (const auto& arm : stencil.half) EXPECT_GT(arm.kappa, 0.0) << ratio;
        EXPECT_NEAR(pd::lattice_moduli(stencil).c11 / (kYoung * 9.0 / 8.0), 1.0, 1e-11) << ratio;
      } catch (const UserError&) {
        EXPECT_LT(ratio, 3.0) << "refused";
      }
    }
}

TEST(Stencil, RefusesTwoThicknesses)
{
  auto o = options<2>(3.0, Micromodulus::conical, Calibration::lattice);
  o.thickness = 1.0;
  EXPECT_THROW(pd::make_stencil<2>(o), UserError);
}

/// In units of dx / c_L [dispersion study].
TEST(Stencil, KnowsThePapersStep)
{
  const auto step = [](double ratio, Micromodulus shape) {
    auto o = options<2>(ratio, shape, Calibration::continuum);
    o.elastic.density = 2450.0;
    return pd::papers_step(pd::make_stencil<2>(o)) * std::sqrt(o.elastic.c11() / o.elastic.density) / kDx;
  };
  EXPECT_NEAR(step(3.0, Micromodulus::conical), 0.957, 1e-3);
  EXPECT_NEAR(step(4.0, Micromodulus::conical), 1.190, 1e-3);
  EXPECT_NEAR(step(6.0, Micromodulus::conical), 1.677, 1e-3);
}
} // namespace
} // namespace pdx::test::stencil
