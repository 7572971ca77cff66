#include "patch.hpp"
#include "pdx/base/symmetric.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using law::Kinematics;

namespace {
constexpr double kYoung = 70e9, kThickness = 2e-3;
const law::Elastic kPlate{kYoung, 0.3, law::Plane::stress, kThickness};
const law::Elastic kThick{kYoung, 0.25, law::Plane::strain, kThickness};
constexpr std::array kBoth{Kinematics::small, Kinematics::finite};

/// A bent and sheared state of the middle cell of the patch, strains of a few per cent.
fem::ElementVector bent()
{
  fem::ElementVector d;
  d << 1e-3, -2e-3, 3e-3, 0.5e-3, -1e-3, 2e-3, 2.5e-3, 1e-3;
  return d;
}
fem::Corners middle() { return Patch{}.corners(Patch{}.cells[4]); }
Tensor<2> rotation(double angle)
{
  return Tensor<2>{{std::cos(angle), -std::sin(angle)}, {std::sin(angle), std::cos(angle)}};
}
} // namespace

TEST(ElasticKernel, LinearFieldLeavesInnerNodesOfADistortedPatchInBalance)
{
  const Patch patch;
  const Tensor<2> gradient{{2e-2, -1e-2}, {3e-2, 1.5e-2}};
  for (const law::Elastic& law : {kPlate, kThick})
    for (const Kinematics kinematics : kBoth) {
      Eigen::Matrix<double, 16, 1> force = Eigen::Matrix<double, 16, 1>::Zero();
      for (const auto& cell : patch.cells) {
        const auto f = fem::element_force(patch.corners(cell), patch.linear(cell, gradient), law, kinematics);
        for (int a = 0; a < 4; ++a) force.segment<2>(2 * cell[a]) += f.segment<2>(2 * a);
      }
      EXPECT_LT(force.tail<8>().norm(), 1e-13 * force.head<8>().norm());
      EXPECT_GT(force.head<8>().norm(), 0.1 * kYoung * 1e-2 * 0.12 * kThickness);
    }
}

TEST(ElasticKernel, StretchedSquarePullsItsEdgesWithTheUniaxialStress)
{
  const double side = 0.5, strain = 1e-3;
  const fem::Corners square{{{0, 0}, {side, 0}, {side, side}, {0, side}}};
  fem::ElementVector d;
  d << 0, 0, strain * side, 0, strain * side, -0.3 * strain * side, 0, -0.3 * strain * side;
  const auto f = fem::element_force(square, d, kPlate, Kinematics::small);
  const double half_edge = 0.5 * kYoung * strain * side * kThickness; // E e side t / 2 = 35 kN
  EXPECT_NEAR(half_edge, 35000.0, 1e-9);
  EXPECT_NEAR(f[2], half_edge, 1e-9 * half_edge);
  EXPECT_NEAR(f[0], -half_edge, 1e-9 * half_edge);
  EXPECT_NEAR(f[5], 0.0, 1e-9 * half_edge);
}

TEST(ElasticKernel, RigidMotionCostsNoForce)
{
  const Patch patch;
  const auto& cell = patch.cells[0];
  const fem::Corners corners = patch.corners(cell);
  const Vector<2> shift(0.01, -0.02);
  const double scale = kYoung * kThickness * 0.1;
  const Tensor<2> spin{{0.0, -0.1}, {0.1, 0.0}}; // infinitesimal rotation by 0.1
  EXPECT_LT(fem::element_force(corners, patch.linear(cell, spin, shift), kPlate, Kinematics::small).norm(),
            1e-14 * scale);
  const Tensor<2> turn = rotation(2.0) - Tensor<2>::Identity();
  const auto turned = patch.linear(cell, turn, shift);
  EXPECT_LT(fem::element_force(corners, turned, kPlate, Kinematics::finite).norm(), 1e-14 * scale);
  EXPECT_GT(fem::element_force(corners, turned, kPlate, Kinematics::small).norm(), 0.1 * scale);
}

TEST(ElasticKernel, FiniteForceTurnsWithTheBody)
{
  const Patch patch;
  const fem::Corners corners = middle();
  const Tensor<2> turn = rotation(0.7);
  fem::ElementVector turned;
  for (int a = 0; a < 4; ++a) {
    const Vector<2>& x = corners[static_cast<std::size_t>(a)];
    turned.segment<2>(2 * a) = turn * (x + bent().segment<2>(2 * a)) - x;
  }
  const auto force = fem::element_force(corners, bent(), kPlate, Kinematics::finite);
  const auto after = fem::element_force(corners, turned, kPlate, Kinematics::finite);
  for (int a = 0; a < 4; ++a)
    EXPECT_LT((after.segment<2>(2 * a) - turn * force.segment<2>(2 * a)).norm(), 1e-12 * force.norm());
}

TEST(ElasticKernel, TangentIsTheDerivativeOfTheForceAndSymmetric)
{
  for (const law::Elastic& law : {kPlate, kThick})
    for (const Kinematics kinematics : kBoth) {
      const auto k = fem::element_tangent(middle(), bent(), law, kinematics);
      EXPECT_LT((k - k.transpose()).norm(), 1e-15 * k.norm());
      const double step = 1e-7; // [m]
      for (int i = 0; i < 8; ++i) {
        const fem::ElementVector d = step * fem::ElementVector::Unit(i);
        const fem::ElementVector slope = (fem::element_force(middle(), bent() + d, law, kinematics) -
                                          fem::element_force(middle(), bent() - d, law, kinematics)) /
                                         (2.0 * step);
        EXPECT_LT((slope - k.col(i)).norm(), 1e-8 * k.norm());
      }
    }
}

TEST(ElasticKernel, ForceIsTheGradientOfTheEnergy)
{
  for (const Kinematics kinematics : kBoth) {
    const auto force = fem::element_force(middle(), bent(), kThick, kinematics);
    const double step = 1e-7; // [m]
    for (int i = 0; i < 8; ++i) {
      const fem::ElementVector d = step * fem::ElementVector::Unit(i);
      const double slope = (fem::element_energy(middle(), bent() + d, kThick, kinematics) -
                            fem::element_energy(middle(), bent() - d, kThick, kinematics)) /
                           (2.0 * step);
      EXPECT_NEAR(slope, force[i], 1e-8 * force.norm());
    }
  }
}

TEST(ElasticKernel, KinematicsAgreeOnTheUndeformedTangent)
{
  const fem::ElementVector rest = fem::ElementVector::Zero();
  const auto small = fem::element_tangent(middle(), rest, kPlate, Kinematics::small);
  const auto finite = fem::element_tangent(middle(), rest, kPlate, Kinematics::finite);
  EXPECT_LT((small - finite).norm(), 1e-15 * small.norm());
  EXPECT_EQ(fem::element_force(middle(), rest, kPlate, Kinematics::finite).norm(), 0.0);
}

TEST(ElasticKernel, UndeformedTangentResistsAllButThreeRigidModes)
{
  const auto k = fem::element_tangent(middle(), fem::ElementVector::Zero(), kPlate, Kinematics::small);
  const Eigen::VectorXd modes = symmetric_eigenvalues(k);
  EXPECT_LT(modes.head<3>().cwiseAbs().maxCoeff(), 1e-14 * modes[7]);
  EXPECT_GT(modes[3], 1e-2 * modes[7]);
}
