#include "cut_plate.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using law::Kinematics;
using xfem::Quadrature;
using xfem::Side;

namespace {
constexpr double kYoung = 70e9, kThickness = 2e-3;
const law::Elastic kPlate{kYoung, 0.3, law::Plane::stress, kThickness};
const law::Elastic kThick{kYoung, 0.25, law::Plane::strain, kThickness};
constexpr std::array kBoth{Kinematics::small, Kinematics::finite};
const fem::Corners kParallelogram{{{0.0, 0.0}, {0.10, 0.02}, {0.13, 0.09}, {0.03, 0.07}}};
const fem::Corners kDistorted{{{0.0, 0.0}, {0.11, 0.01}, {0.09, 0.10}, {-0.01, 0.07}}};
constexpr std::array<bool, 4> kAll{true, true, true, true};

xfem::EnrichedElement cut(const fem::Corners& corners, const Line& line, const std::array<bool, 4>& enriched = kAll,
                          Quadrature quadrature = Quadrature::polygons, int subcells = xfem::kGridSubcells)
{
  xfem::CornerDistances distance;
  xfem::EnrichedElement element;
  for (std::size_t a = 0; a < 4; ++a) {
    distance[a] = line.distance(corners[a]);
    element.side[a] = xfem::side_of(distance[a]);
  }
  element.cell = xfem::cut_cell(corners, distance, quadrature, subcells);
  element.enriched = enriched;
  return element;
}

/// Random lines through points near the middle of the cells above.
Line random_line(std::mt19937& random)
{
  std::uniform_real_distribution<double> x(0.01, 0.09), y(0.01, 0.07), angle(0.0, 2.0 * std::numbers::pi);
  return {{x(random), y(random)}, angle(random)};
}
const Line kLine{{0.06, 0.04}, 0.4};

/// Unknowns of a fully enriched element for a displacement field(x, side).
template <class Field>
xfem::EnrichedVector unknowns_of(const fem::Corners& corners, const xfem::EnrichedElement& element, Field&& field)
{
  xfem::EnrichedVector d(16);
  for (int a = 0; a < 4; ++a) {
    const auto corner = static_cast<std::size_t>(a);
    const Side here = element.side[corner], there = xfem::opposite(here);
    d.segment<2>(2 * a) = field(corners[corner], here);
    d.segment<2>(8 + 2 * a) =
        (field(corners[corner], there) - field(corners[corner], here)) / xfem::shifted_step(there, here);
  }
  return d;
}

/// Strains of a few per cent and an opening of a few millimetres.
xfem::EnrichedVector opened(int unknowns)
{
  xfem::EnrichedVector d(unknowns);
  for (int i = 0; i < unknowns; ++i) d[i] = 2e-3 * std::sin(1.0 + 2.3 * i);
  return d;
}
Tensor<2> rotation(double angle)
{
  return Tensor<2>{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
}
} // namespace

TEST(EnrichedKernel, HalvesMoveRigidlyWithoutForceAtTwoHundredRandomCuts)
{
  std::mt19937 random(1);
  for (int trial = 0; trial < 200; ++trial)
    for (const Kinematics kinematics : kBoth) {
      const fem::Corners& corners = trial % 2 ? kParallelogram : kDistorted;
      const auto element = cut(corners, random_line(random));
      const auto rigid = [&](const Vector<2>& x, Side side) -> Vector<2> {
        const double angle = side == Side::plus ? 0.5 : -0.8;
        const Vector<2> shift = side == Side::plus ? Vector<2>(0.02, 0.05) : Vector<2>(-0.03, 0.01);
        if (kinematics == Kinematics::small) return shift + 0.1 * angle * Vector<2>(-x.y(), x.x());
        return shift + rotation(angle) * x - x;
      };
      const auto force = xfem::enriched_force(element, unknowns_of(corners, element, rigid), kPlate, kinematics);
      EXPECT_LT(force.norm(), 1e-12 * kYoung * kThickness * 0.05) << trial;
    }
}

TEST(EnrichedKernel, ConstantStrainOnEitherSideHasItsExactEnergy)
{
  std::mt19937 random(2);
  const std::array<Tensor<2>, 2> gradient{Tensor<2>{{1e-3, 2e-3}, {0.0, -2e-3}}, Tensor<2>{{-3e-3, 0.0}, {1e-3, 5e-4}}};
  for (int trial = 0; trial < 200; ++trial) {
    const fem::Corners& corners = trial % 2 ? kParallelogram : kDistorted;
    const Line line = random_line(random);
    const auto element = cut(corners, line);
    const auto linear = [&](const Vector<2>& x, Side side) -> Vector<2> {
      return gradient[static_cast<std::size_t>(side)] * x + step(side) * Vector<2>(1e-3, 2e-3);
    };
    xfem::CornerDistances distance;
    for (std::size_t a = 0; a < 4; ++a) distance[a] = line.distance(corners[a]);
    const xfem::SideAreas areas = xfem::side_areas(corners, distance, Quadrature::polygons);
    double exact = 0.0;
    for (const Side side : xfem::kSides) {
      const Tensor<2>& g = gradient[static_cast<std::size_t>(side)];
      const Eigen::Vector3d strain(g(0, 0), g(1, 1), g(0, 1) + g(1, 0));
      exact += 0.5 * areas[side] * kThickness * strain.dot(kThick.stiffness() * strain);
    }
    const double energy =
        xfem::enriched_energy(element, unknowns_of(corners, element, linear), kThick, Kinematics::small);
    EXPECT_NEAR(energy, exact, 1e-12 * exact) << trial;
  }
}

TEST(EnrichedKernel, WithoutEnrichedCornersItIsThePlainElement)
{
  std::mt19937 random(3);
  const fem::ElementVector d = opened(8);
  const auto plain = fem::element_tangent(kParallelogram, d, kPlate, Kinematics::small);
  for (int trial = 0; trial < 50; ++trial) {
    const auto element = cut(kParallelogram, random_line(random), {});
    ASSERT_EQ(element.unknowns(), 8);
    EXPECT_LT((xfem::enriched_tangent(element, d, kPlate, Kinematics::small) - plain).norm(), 1e-13 * plain.norm());
  }
  for (const Kinematics kinematics : kBoth) { // a whole cell has the plain element's own points
    const xfem::EnrichedElement whole{xfem::whole_cell(kDistorted, Side::minus), {}, {}, {}};
    const auto force = fem::element_force(kDistorted, d, kPlate, kinematics);
    EXPECT_LT((xfem::enriched_force(whole, d, kPlate, kinematics) - force).norm(), 1e-14 * force.norm());
  }
}

TEST(EnrichedKernel, FiniteStrainEnergyOfAParallelogramDoesNotDependOnWhereItIsCut)
{
  std::mt19937 random(4);
  xfem::EnrichedVector d = opened(16);
  d.tail<8>().setZero(); // no opening: the cut only moves quadrature points
  const auto first = cut(kParallelogram, kLine);
  const double energy = xfem::enriched_energy(first, d, kPlate, Kinematics::finite);
  for (int trial = 0; trial < 50; ++trial) {
    const auto element = cut(kParallelogram, random_line(random));
    EXPECT_NEAR(xfem::enriched_energy(element, d, kPlate, Kinematics::finite), energy, 1e-13 * energy);
  }
}

TEST(EnrichedKernel, EachHalfIsAnElementOfItsOwn)
{
  // What one side's field does cannot be felt on the other: stretch the plus half, hold the minus half.
  const auto element = cut(kParallelogram, kLine);
  const auto field = [](const Vector<2>& x, Side side) -> Vector<2> {
    return side == Side::plus ? Vector<2>(1e-3 * x.x(), -2e-3 * x.y()) : Vector<2>(0.0, 0.0);
  };
  const auto d = unknowns_of(kParallelogram, element, field);
  const auto on_minus = xfem::side_map(element, Side::minus);
  EXPECT_LT((on_minus * d).norm(), 1e-15 * d.norm());
  // Work of the force on any motion of the minus half alone is zero.
  const auto force = xfem::enriched_force(element, d, kPlate, Kinematics::small);
  const auto push = [](const Vector<2>& x, Side side) -> Vector<2> {
    return side == Side::minus ? Vector<2>(x.y() * x.x(), 1.0 - x.y()) : Vector<2>(0.0, 0.0);
  };
  EXPECT_LT(std::abs(force.dot(unknowns_of(kParallelogram, element, push))), 1e-13 * force.norm());
  EXPECT_GT(force.norm(), 0.1 * kYoung * 1e-3 * 0.05 * kThickness);
}

TEST(EnrichedKernel, TangentIsTheDerivativeOfTheForceAndSymmetric)
{
  const std::array<bool, 4> some{true, false, true, true};
  for (const law::Elastic& law : {kPlate, kThick})
    for (const Kinematics kinematics : kBoth)
      for (const auto& enriched : {kAll, some}) {
        const auto element = cut(kDistorted, kLine, enriched);
        const auto d = opened(element.unknowns());
        const auto k = xfem::enriched_tangent(element, d, law, kinematics);
        EXPECT_LT((k - k.transpose()).norm(), 1e-15 * k.norm());
        const double step = 1e-7; // [m]
        for (int i = 0; i < element.unknowns(); ++i) {
          xfem::EnrichedVector up = d, down = d;
          up[i] += step;
          down[i] -= step;
          const xfem::EnrichedVector slope = (xfem::enriched_force(element, up, law, kinematics) -
                                              xfem::enriched_force(element, down, law, kinematics)) /
                                             (2.0 * step);
          EXPECT_LT((slope - k.col(i)).norm(), 1e-8 * k.norm());
        }
      }
}

TEST(EnrichedKernel, ForceIsTheGradientOfTheEnergy)
{
  for (const Kinematics kinematics : kBoth) {
    const auto element = cut(kDistorted, kLine);
    const auto d = opened(16);
    const auto force = xfem::enriched_force(element, d, kThick, kinematics);
    const double step = 1e-7; // [m]
    for (int i = 0; i < 16; ++i) {
      xfem::EnrichedVector up = d, down = d;
      up[i] += step;
      down[i] -= step;
      const double slope = (xfem::enriched_energy(element, up, kThick, kinematics) -
                            xfem::enriched_energy(element, down, kThick, kinematics)) /
                           (2.0 * step);
      EXPECT_NEAR(slope, force[i], 1e-8 * force.norm());
    }
  }
}

TEST(EnrichedKernel, GridQuadratureConvergesToPolygons)
{
  const auto d = opened(16);
  for (const fem::Corners& corners : {kParallelogram, kDistorted}) {
    const auto exact = xfem::enriched_tangent(cut(corners, kLine), d, kPlate, Kinematics::finite);
    const auto error = [&](int subcells) {
      const auto grid = cut(corners, kLine, kAll, Quadrature::grid, subcells);
      return (xfem::enriched_tangent(grid, d, kPlate, Kinematics::finite) - exact).norm() / exact.norm();
    };
    EXPECT_LT(error(32), 1e-2);
    EXPECT_GT(error(32), 1e-6); // not the same points
    EXPECT_LT(error(512), 5e-4);
  }
}

TEST(Cut, SidesShareTheAreaOfTheCell)
{
  const fem::Corners square{{{0.0, 0.0}, {0.2, 0.0}, {0.2, 0.2}, {0.0, 0.2}}};
  const xfem::CornerDistances distance{-0.05, -0.05, 0.15, 0.15}; // y - 0.05
  for (const Quadrature quadrature : {Quadrature::polygons, Quadrature::grid}) {
    const xfem::SideAreas areas = xfem::side_areas(square, distance, quadrature);
    EXPECT_NEAR(areas[Side::minus], 0.01, 1e-15);
    EXPECT_NEAR(areas[Side::plus], 0.03, 1e-15);
    EXPECT_NEAR(areas.share(Side::minus), 0.25, 1e-14);
  }
  EXPECT_EQ(xfem::cut_cell(square, distance, Quadrature::grid).points(Side::minus).size(), 256u); // a quarter of 32^2
}

TEST(Heaviside, ShiftedStepIsZeroOnTheNodesOwnSideAndTwoAcross)
{
  EXPECT_EQ(xfem::shifted_step(Side::plus, Side::plus), 0.0);
  EXPECT_EQ(xfem::shifted_step(Side::minus, Side::minus), 0.0);
  EXPECT_EQ(xfem::shifted_step(Side::plus, Side::minus), 2.0);
  EXPECT_EQ(xfem::shifted_step(Side::minus, Side::plus), -2.0);
  EXPECT_EQ(xfem::side_of(0.0), Side::plus);
  EXPECT_EQ(xfem::side_of(-0.0), Side::plus);
  EXPECT_EQ(xfem::side_of(-1e-300), Side::minus);
}
