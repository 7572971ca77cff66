#include "pdx/base/error.hpp"
#include "pdx/law/bond.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace {
using namespace pdx::law;
constexpr double kYoung = 192e9, kHorizon = 4e-3, kThickness = 2e-3, kToughness = 135.0, kPi = std::numbers::pi;

Elastic solid(double poisson, Plane plane) { return {kYoung, poisson, plane, kThickness}; }

/// Stiffness of the continuous family under a uniform strain e_xx (C11) by midpoint quadrature over directions and
/// lengths: C11 = 1/2 int c xi n_x^4 dV'.
template <int Dim> double c11_by_quadrature(const BondLaw<Dim>& law)
{
  constexpr int n = 400;
  double sum = 0.0;
  for (int r = 0; r < n; ++r) {
    const double xi = (r + 0.5) / n * kHorizon, dxi = kHorizon / n;
    for (int a = 0; a < n; ++a) {
      if constexpr (Dim == 2) {
        const double angle = (a + 0.5) / n * 2.0 * kPi;
        sum += 0.5 * law.constant(xi) * xi * std::pow(std::cos(angle), 4) * xi * dxi * (2.0 * kPi / n) * kThickness;
      } else {
        const double cosine = -1.0 + (a + 0.5) / n * 2.0; // of the angle to x
        sum += 0.5 * law.constant(xi) * xi * std::pow(cosine, 4) * 2.0 * kPi * xi * xi * dxi * (2.0 / n);
      }
    }
  }
  return sum;
}

TEST(BondLaw, FamilyHasTheStiffnessOfTheSolid)
{
  for (const Micromodulus shape : {Micromodulus::uniform, Micromodulus::conical}) {
    const BondLaw<2> stress(shape, solid(1.0 / 3.0, Plane::stress), kHorizon);
    EXPECT_NEAR(c11_by_quadrature(stress) / stress.elastic().c11(), 1.0, 1e-4);
    const BondLaw<2> strain(shape, solid(0.25, Plane::strain), kHorizon);
    EXPECT_NEAR(c11_by_quadrature(strain) / strain.elastic().c11(), 1.0, 1e-4);
    const BondLaw<3> space(shape, solid(0.25, Plane::strain), kHorizon);
    EXPECT_NEAR(c11_by_quadrature(space) / space.elastic().c11(), 1.0, 1e-4);
  }
}

TEST(BondLaw, ConstantsArePrintedOnes)
{
  const double d3 = std::pow(kHorizon, 3), d4 = std::pow(kHorizon, 4), half = kHorizon / 2.0;
  const auto plate = solid(1.0 / 3.0, Plane::stress);
  EXPECT_DOUBLE_EQ(BondLaw<2>(Micromodulus::uniform, plate, kHorizon).constant(half),
                   9.0 * kYoung / (kPi * kThickness * d3));
  EXPECT_DOUBLE_EQ(BondLaw<2>(Micromodulus::conical, plate, kHorizon).constant(half),
                   18.0 * kYoung / (kPi * kThickness * d3));
  EXPECT_DOUBLE_EQ(BondLaw<2>(Micromodulus::conical, plate, kHorizon).constant(1.1 * kHorizon), 0.0);
  const auto cube = solid(0.25, Plane::strain);
  EXPECT_DOUBLE_EQ(BondLaw<3>(Micromodulus::conical, cube, kHorizon).constant(half), 30.0 * kYoung / (kPi * d4));
}

TEST(BondLaw, CriticalStretchIsPrintedOne)
{
  const double unit = kToughness / (kYoung * kHorizon);
  const auto plate = solid(1.0 / 3.0, Plane::stress), thick = solid(0.25, Plane::strain);
  const auto uniform = Micromodulus::uniform, conical = Micromodulus::conical;
  const auto square = [](double s) { return s * s; };
  EXPECT_NEAR(square(BondLaw<2>(uniform, plate, kHorizon).critical_stretch(kToughness)), 4.0 * kPi / 9.0 * unit,
              1e-12 * unit);
  EXPECT_NEAR(square(BondLaw<2>(conical, plate, kHorizon).critical_stretch(kToughness)), 5.0 * kPi / 9.0 * unit,
              1e-12 * unit);
  EXPECT_NEAR(square(BondLaw<2>(uniform, thick, kHorizon).critical_stretch(kToughness)), 5.0 * kPi / 12.0 * unit,
              1e-12 * unit);
  EXPECT_NEAR(square(BondLaw<2>(conical, thick, kHorizon).critical_stretch(kToughness)), 25.0 * kPi / 48.0 * unit,
              1e-12 * unit);
  EXPECT_NEAR(square(BondLaw<3>(uniform, thick, kHorizon).critical_stretch(kToughness)), 5.0 / 6.0 * unit,
              1e-12 * unit);
  EXPECT_NEAR(square(BondLaw<3>(conical, thick, kHorizon).critical_stretch(kToughness)), unit, 1e-12 * unit);
}

TEST(BondLaw, TakesOnlyThePoissonsRatioOfCentralForces)
{
  const auto make = [](double poisson, Plane plane) {
    return BondLaw<2>(Micromodulus::conical, solid(poisson, plane), kHorizon);
  };
  EXPECT_EQ(make(0.333, Plane::stress).elastic().poisson, 1.0 / 3.0);
  EXPECT_EQ(make(0.333, Plane::stress).constant(0.0), make(1.0 / 3.0, Plane::stress).constant(0.0));
  EXPECT_THROW(make(0.22, Plane::stress), pdx::UserError);
  EXPECT_THROW(make(0.25, Plane::stress), pdx::UserError);
  EXPECT_THROW(make(1.0 / 3.0, Plane::strain), pdx::UserError);
  EXPECT_THROW(make(std::nan(""), Plane::strain), pdx::UserError);
  EXPECT_EQ(required_poisson(3, Plane::stress), 0.25);
  try {
    make(0.22, Plane::stress);
  } catch (const pdx::UserError& error) {
    EXPECT_NE(std::string(error.what()).find("0.333333 in plane stress"), std::string::npos) << error.what();
  }
}

TEST(BondLaw, RefusesNumbersThatAreNotPositive)
{
  Elastic flat = solid(1.0 / 3.0, Plane::stress);
  EXPECT_THROW(BondLaw<2>(Micromodulus::uniform, flat, 0.0), pdx::UserError);
  flat.thickness = 0.0;
  EXPECT_THROW(BondLaw<2>(Micromodulus::uniform, flat, kHorizon), pdx::UserError);
  flat.thickness = 1.0;
  flat.young = -1.0;
  EXPECT_THROW(BondLaw<2>(Micromodulus::uniform, flat, kHorizon), pdx::UserError);
}
} // namespace
