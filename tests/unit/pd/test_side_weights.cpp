#include "pdx/pd/side_weights.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <numbers>

// The figures are those of an independent program (a prototype in another language), to the digits given.
namespace {
using namespace pdx;
using Aim = pd::SideWeights::Aim;

constexpr double kDx = 2.5e-3;
const law::Elastic kElastic{70e9, 1.0 / 3.0, law::Plane::stress, 2e-3, 2500.0};

pd::Stencil<2> stencil(double ratio, law::Micromodulus micromodulus)
{
  return pd::make_stencil<2>({kDx, kElastic.thickness, ratio * kDx, micromodulus, pd::Calibration::lattice, kElastic});
}

struct Column {
  const char* name;
  double ratio;
  law::Micromodulus micromodulus;
  double tension_none[3]; ///< E/E0 uncorrected at horizon / width = 0.2, 0.1, 0.05
  double bending_none[2]; ///< EI uncorrected, 8 and 16 rows
  double bending[2];      ///< and corrected
  double loose_volume;    ///< largest force on a particle in uniform tension by the volume method [sigma dx t]
  double rayleigh[2];     ///< speed at wavelengths of 40 and 80 dx, corrected
  double rayleigh_none;   ///< and uncorrected at 80
};
constexpr auto kConical = law::Micromodulus::conical, kUniform = law::Micromodulus::uniform;
const Column kColumns[] = {
    {"3 conical", 3, kConical, {.967, .984, .992}, {.827, .911}, {.999, 1.000}, .052, {.998, 1.000}, .995},
    {"4 conical", 4, kConical, {.964, .982, .991}, {.764, .874}, {.997, .999}, .057, {.997, .999}, .993},
    {"3 uniform", 3, kUniform, {.953, .976, .988}, {.765, .875}, {.997, .999}, .069, {.997, .999}, .993},
    {"4 uniform", 4, kUniform, {.952, .976, .988}, {.700, .836}, {.993, .998}, .060, {.994, .999}, .991},
};
constexpr double kDigit = 6e-4; // half of the last digit of the figures, and a little

double factor(const pd::SideWeights* weights, const pd::Arm<2>& arm, int row)
{
  return weights ? weights->at(row, std::abs(arm.step[0]), arm.step[1]) : 1.0;
}

TEST(SideWeights, BarsAreAsStiffAsTheirMaterial)
{
  for (const Column& c : kColumns) {
    SCOPED_TRACE(c.name);
    const auto bonds = stencil(c.ratio, c.micromodulus);
    const auto weights = pd::SideWeights::solve(bonds, Aim::bending);
    ASSERT_TRUE(weights);
    EXPECT_TRUE(weights->all_strains());
    for (int k = 0; k < 3; ++k) {
      const int rows = static_cast<int>(std::lround(c.ratio / (0.2 / (1 << k))));
      EXPECT_NEAR(pd::bar_stiffness(bonds, nullptr, rows).tension, c.tension_none[k], kDigit) << rows;
      EXPECT_NEAR(pd::bar_stiffness(bonds, &*weights, rows).tension, 1.0, 1e-10) << rows;
    }
  }
}

TEST(SideWeights, BendingIsOfSecondOrder)
{
  for (const Column& c : kColumns) {
    SCOPED_TRACE(c.name);
    const auto bonds = stencil(c.ratio, c.micromodulus);
    const auto weights = pd::SideWeights::solve(bonds, Aim::bending);
    const auto bending = [&](const pd::SideWeights* w, int rows) { return pd::bar_stiffness(bonds, w, rows).bending; };
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(bending(nullptr, 8 << k), c.bending_none[k], kDigit);
      EXPECT_NEAR(bending(&*weights, 8 << k), c.bending[k], kDigit);
    }
    EXPECT_GT(std::log2((1.0 - bending(&*weights, 16)) / (1.0 - bending(&*weights, 32))), 1.85);
    EXPECT_LT(std::log2((1.0 - bending(nullptr, 16)) / (1.0 - bending(nullptr, 32))), 1.1);
  }
}

/// n rows bend by about 1/n^2 too easily, by as much as a lattice's own rows do not bend.
TEST(SideWeights, ForElementsTensionIsWhereItShouldBe)
{
  for (const Column& c : kColumns) {
    const auto bonds = stencil(c.ratio, c.micromodulus);
    const auto own = pd::SideWeights::solve(bonds, Aim::bending), met = pd::SideWeights::solve(bonds, Aim::traction);
    std::array<double, 2> lack{}; // at 16 and 32 rows
    for (int k = 0; k < 2; ++k) {
      const auto bar = pd::bar_stiffness(bonds, &*met, 16 << k);
      EXPECT_NEAR(bar.tension, 1.0, 1e-10);
      lack[k] = pd::bar_stiffness(bonds, &*own, 16 << k).bending - bar.bending;
    }
    EXPECT_GT(lack[1], 0.0);
    EXPECT_NEAR(std::log2(lack[0] / lack[1]), 2.0, 0.15);
    // Zeroth and first moment of the forces that cross a line through 40 rows, from where the side is.
    double force = 0.0, moment = 0.0, bulk = 0.0;
    for (const pd::Arm<2>& arm : bonds.half) {
      const double nx = arm.xi[0] / arm.length, ny = arm.xi[1] / arm.length;
      const double pull = arm.kappa * (nx * nx - ny * ny / 3.0) * nx;
      const int across = arm.step[1], crossings = std::abs(arm.step[0]), sign = arm.step[0] < 0 ? -1 : 1;
      bulk += pull * arm.step[0];
      for (int row = 0; row < 80; ++row)
        for (int j = 0; j < crossings; ++j) {
          const double y = row + 0.5 + across * (j + 0.5) / crossings;
          if (y > 40.0 + 1e-9) continue;
          const double part = (y > 40.0 - 1e-9 ? 0.5 : 1.0) * sign * factor(&*met, arm, row) * pull;
          force += part;
          moment += part * y;
        }
    }
    EXPECT_NEAR(force / bulk, 40.0, 1e-9) << c.name;
    EXPECT_NEAR(moment / bulk, 800.0, 1e-8) << c.name;
  }
}

/// Largest force on the rows of a half plane at uniform strain, over E dx t; with the traction of that strain on row 0.
double largest_force(const pd::Stencil<2>& bonds, const pd::SideWeights* weights, const Tensor<2>& strain)
{
  const Tensor<2> stress =
      law::Elastic{1.0, 1.0 / 3.0, law::Plane::stress, 1.0}.c12() * 2.0 * strain +
      law::Elastic{1.0, 1.0 / 3.0, law::Plane::stress, 1.0}.c12() * strain.trace() * Tensor<2>::Identity();
  std::vector<Vector<2>> force(40, Vector<2>::Zero());
  force[0] = -stress.col(1); // the outward normal is -y
  for (const pd::Arm<2>& arm : bonds.half)
    for (int row = 0; row + arm.step[1] < 40; ++row) {
      const Vector<2> n = arm.xi / arm.length;
      const Vector<2> pull =
          factor(weights, arm, row) * arm.kappa * n.dot(strain * n) * n / (kElastic.young * bonds.dx * bonds.thickness);
      force[static_cast<std::size_t>(row)] += pull;
      force[static_cast<std::size_t>(row + arm.step[1])] -= pull;
    }
  double largest = 0.0;
  for (int row = 0; row < 20; ++row) largest = std::max(largest, force[static_cast<std::size_t>(row)].norm());
  return largest;
}

TEST(SideWeights, UniformStrainIsAtRestWithItsTraction)
{
  Tensor<2> tension, across, shear;
  tension << 1.0, 0.0, 0.0, -1.0 / 3.0;
  across << 0.0, 0.0, 0.0, 1.0;
  shear << 0.0, 0.5, 0.5, 0.0;
  for (const Column& c : kColumns) {
    SCOPED_TRACE(c.name);
    const auto bonds = stencil(c.ratio, c.micromodulus);
    EXPECT_NEAR(largest_force(bonds, nullptr, tension), c.loose_volume, kDigit);
    for (const Aim aim : {Aim::bending, Aim::traction}) {
      const auto weights = pd::SideWeights::solve(bonds, aim);
      for (const Tensor<2>& strain : {tension, across, shear})
        EXPECT_LT(largest_force(bonds, &*weights, strain), 1e-12);
    }
  }
  const auto wide = stencil(5, kUniform); // no factors can do it all
  const auto weights = pd::SideWeights::solve(wide, Aim::bending);
  EXPECT_FALSE(weights->all_strains());
  EXPECT_LT(largest_force(wide, &*weights, tension), 1e-12);
  EXPECT_GT(largest_force(wide, &*weights, across), 1e-3);
}

/// Speed of the slowest wave along a free side over Rayleigh's, at wavelengths of n dx: rows of amplitudes with a depth
/// of two wavelengths, held below.
double rayleigh(const pd::Stencil<2>& bonds, const pd::SideWeights* weights, int n)
{
  using Complex = std::complex<double>;
  const int rows = 2 * n;
  const double k = 2.0 * std::numbers::pi / n;
  Eigen::MatrixXcd stiffness = Eigen::MatrixXcd::Zero(2 * rows, 2 * rows);
  for (const pd::Arm<2>& arm : bonds.half)
    for (int row = 0; row < rows; ++row) {
      const int other = row + arm.step[1];
      const Vector<2> n_ = arm.xi / arm.length;
      const Tensor<2> block = factor(weights, arm, row) * arm.kappa / arm.length * n_ * n_.transpose();
      const Complex phase = std::exp(Complex(0.0, k * arm.step[0]));
      stiffness.block<2, 2>(2 * row, 2 * row) += block.cast<Complex>();
      if (other >= rows) continue;
      stiffness.block<2, 2>(2 * other, 2 * other) += block.cast<Complex>();
      stiffness.block<2, 2>(2 * row, 2 * other) -= phase * block.cast<Complex>();
      stiffness.block<2, 2>(2 * other, 2 * row) -= std::conj(phase) * block.cast<Complex>();
    }
  const double mass = kElastic.density * bonds.volume();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(stiffness / mass, Eigen::EigenvaluesOnly);
  const double shear = std::sqrt(kElastic.young / (2.0 * (1.0 + 1.0 / 3.0)) / kElastic.density);
  return std::sqrt(solver.eigenvalues()[0]) / (k / bonds.dx) / (0.919403 * shear);
}

TEST(SideWeights, RayleighWavesAreOfSecondOrder)
{
  for (const Column& c : {kColumns[0], kColumns[1]}) {
    SCOPED_TRACE(c.name);
    const auto bonds = stencil(c.ratio, c.micromodulus);
    const auto weights = pd::SideWeights::solve(bonds, Aim::bending);
    const double at_40 = rayleigh(bonds, &*weights, 40), at_80 = rayleigh(bonds, &*weights, 80);
    EXPECT_NEAR(at_40, c.rayleigh[0], kDigit);
    EXPECT_NEAR(at_80, c.rayleigh[1], kDigit);
    EXPECT_GT(std::log2((1.0 - at_40) / (1.0 - at_80)), 1.8);
    const double none = rayleigh(bonds, nullptr, 80);
    EXPECT_NEAR(none, c.rayleigh_none, kDigit);
    EXPECT_LT(std::log2((1.0 - rayleigh(bonds, nullptr, 40)) / (1.0 - none)), 1.2);
  }
}

TEST(SideWeights, StayWithinTheirBounds)
{
  for (const double ratio : {2.5, 3.0, 3.015, 3.5, 4.0, 5.0, 6.0, 7.0})
    for (const auto micromodulus : {kConical, kUniform})
      for (const Aim aim : {Aim::bending, Aim::traction}) {
        SCOPED_TRACE(testing::Message() << ratio << " uniform " << (micromodulus == kUniform));
        const auto bonds = stencil(ratio, micromodulus);
        const auto weights = pd::SideWeights::solve(bonds, aim);
        ASSERT_TRUE(weights);
        EXPECT_EQ(weights->rows(), bonds.reach);
        for (const pd::Arm<2>& arm : bonds.half) {
          for (int row = 0; row < bonds.reach; ++row) {
            EXPECT_GE(factor(&*weights, arm, row), 0.2 - 1e-12);
            EXPECT_LE(factor(&*weights, arm, row), 3.0 + 1e-12);
          }
          EXPECT_EQ(factor(&*weights, arm, bonds.reach), 1.0);
        }
      }
}

TEST(SideWeights, AreNoneForTooFewBonds)
{
  const auto bonds =
      pd::make_stencil<2>({kDx, kElastic.thickness, 2.0 * kDx, kConical, pd::Calibration::continuum, kElastic});
  EXPECT_FALSE(pd::SideWeights::solve(bonds, Aim::bending));
}
} // namespace
