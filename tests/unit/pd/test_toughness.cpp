#include "pdx/base/error.hpp"
#include "pdx/pd/breaker.hpp"
#include "pdx/pd/toughness.hpp"
#include "window.hpp"

#include <gtest/gtest.h>

namespace pdx::test::toughness {
namespace {
using law::Micromodulus;
using pd::Calibration;
using pd::Toughness;
constexpr double kGc = 135.0, kDx = 2.5e-5, kThickness = 2e-3;

template <int Dim> pd::StencilOptions options(double ratio, Micromodulus shape, Calibration calibration)
{
  const law::Elastic elastic{192e9, law::required_poisson(Dim, law::Plane::stress), law::Plane::stress, kThickness};
  return {kDx, kThickness, ratio * kDx, shape, calibration, elastic};
}

/// Energy per area to part all bonds from one row of sites and below to the rows above, found among all pairs of sites
/// whose bond crosses the middle between rows 0 and 1 [J/m^2]; one site for each column, as all are alike.
template <int Dim> double energy_to_part(const pd::Stencil<Dim>& stencil, double s0)
{
  const int reach = stencil.reach;
  const double area = Dim == 2 ? kDx * kThickness : kDx * kDx;
  double energy = 0.0;
  for (int from = -reach; from <= 0; ++from)
    for (int to = 1; to <= reach; ++to)
      for (const auto& arm : stencil.half)
        for (const int sign : {1, -1})
          if (sign * arm.step[1] == to - from) energy += 0.5 * arm.kappa * s0 * s0 * arm.xi.norm();
  return energy / area;
}

template <int Dim> void expect_gc(double ratio, Micromodulus shape, Calibration calibration)
{
  const auto o = options<Dim>(ratio, shape, calibration);
  law::Elastic solid = o.elastic;
  if (Dim == 3) solid.plane = law::Plane::strain;
  const law::BondLaw<Dim> bond(shape, solid, o.horizon);
  const auto stencil = pd::make_stencil<Dim>(o);
  const double s0 = pd::critical_stretch<Dim>(stencil, bond, kGc, Toughness::lattice);
  EXPECT_NEAR(energy_to_part(stencil, s0) / kGc, 1.0, 1e-10) << Dim << "-D, m = " << ratio;
  // a correction, not another law
  EXPECT_NEAR(s0 / pd::critical_stretch<Dim>(stencil, bond, kGc, Toughness::continuum), 1.0, 0.1);
}

TEST(Toughness, PartingARowCostsGcExactly)
{
  for (const auto calibration : {Calibration::continuum, Calibration::lattice})
    for (const auto shape : {Micromodulus::conical, Micromodulus::uniform})
      for (const double ratio : {3.0, 3.015, 4.0, 6.0}) {
        expect_gc<2>(ratio, shape, calibration);
        expect_gc<3>(ratio, shape, calibration);
      }
}

// The bonds that a crack between two rows of a real window cuts, counted for the particles' middle columns.
TEST(Toughness, IsTheEnergyOfTheBondsThatACrackCuts)
{
  test::Window<2> window({40, 16}, {.ratio = 4.0});
  const auto& stencil = window.stencil;
  const double thickness = stencil.thickness, y = (stencil.reach + 8) * kDx;
  const law::Elastic elastic{192e9, 1.0 / 3.0, law::Plane::stress, thickness};
  const law::BondLaw<2> bond(Micromodulus::conical, elastic, stencil.horizon);
  const double s0 = pd::critical_stretch<2>(stencil, bond, kGc, Toughness::lattice);
  const auto before = window.words[0];
  pd::cut_bonds<2>(crack::CrackSet({{{-1.0, y}, {1.0, y}}}, geom::Box<2>{{-2.0, -2.0}, {2.0, 2.0}}),
                   {window.sites, {}, window.sites.count}, stencil, window.runs,
                   {window.words[0].data(), window.words[1].data()});
  double energy = 0.0;
  for (const std::ptrdiff_t i : window.particles) {
    const Index column = window.sites.site(i)[0] - stencil.reach;
    for (std::size_t h = 0; h < window.arms.size(); ++h)
      if (column >= 10 && column < 30 && ((before[i] ^ window.words[0][i]) >> h & 1u))
        energy += 0.5 * window.arms[h].kappa * s0 * s0 * window.arms[h].length;
  }
  EXPECT_NEAR(energy / (20 * kDx * thickness) / kGc, 1.0, 1e-10);
}

TEST(Toughness, ContinuumIsTheLawsOwn)
{
  const auto o = options<2>(4.0, Micromodulus::conical, Calibration::continuum);
  const law::BondLaw<2> bond(o.micromodulus, o.elastic, o.horizon);
  const auto stencil = pd::make_stencil<2>(o);
  EXPECT_EQ(pd::critical_stretch<2>(stencil, bond, kGc, Toughness::continuum), bond.critical_stretch(kGc));
  const double s0 = pd::critical_stretch<2>(stencil, bond, kGc, Toughness::lattice);
  EXPECT_NEAR(s0 / bond.critical_stretch(kGc), 1.0 / std::sqrt(.9585), 5e-5); // the lattice is 4 % cheap
}

TEST(Toughness, RefusesWhatIsNotPositive)
{
  const auto o = options<2>(4.0, Micromodulus::conical, Calibration::lattice);
  const law::BondLaw<2> bond(o.micromodulus, o.elastic, o.horizon);
  const auto stencil = pd::make_stencil<2>(o);
  for (const double gc : {0.0, -1.0, std::nan("")})
    for (const auto by : {Toughness::lattice, Toughness::continuum})
      EXPECT_THROW(pd::critical_stretch<2>(stencil, bond, gc, by), UserError);
}
} // namespace
} // namespace pdx::test::toughness
