#include "pdx/law/solid_law.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

namespace test_solid_law {
using namespace pdx;
using namespace pdx::law;
constexpr double kPoisson = 0.3, kDensity = 4.0;

Elastic solid(Plane plane = Plane::stress) { return {10.0, kPoisson, plane, 1.0, kDensity}; }

template <int Dim, class Law> Tensor<Dim> stress(const Law& law, const Tensor<Dim>& h)
{
  double from[Dim][Dim], p[Dim][Dim];
  Tensor<Dim> all;
  for (int i = 0; i < Dim * Dim; ++i) from[i / Dim][i % Dim] = h(i / Dim, i % Dim);
  law.stress(from, p);
  for (int i = 0; i < Dim * Dim; ++i) all(i / Dim, i % Dim) = p[i / Dim][i % Dim];
  return all;
}
template <int Dim, class Law> double energy(const Law& law, const Tensor<Dim>& h)
{
  double from[Dim][Dim];
  for (int i = 0; i < Dim * Dim; ++i) from[i / Dim][i % Dim] = h(i / Dim, i % Dim);
  return law.energy(from);
}

template <int Dim> Tensor<Dim> turned(double angle)
{
  if constexpr (Dim == 2)
    return Eigen::Rotation2Dd(angle).toRotationMatrix();
  else
    return Eigen::AngleAxisd(angle, Vector<3>(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
}
/// Some matrix of the given size, the same for the same number.
template <int Dim> Tensor<Dim> some(int number, double size)
{
  Tensor<Dim> a;
  for (int i = 0; i < Dim * Dim; ++i) a(i / Dim, i % Dim) = size * std::sin(1.7 * i * i + 2.3 * number + 0.4 * i + 1.0);
  return a;
}
/// Small and large strains, some of them turned.
template <int Dim> std::vector<Tensor<Dim>> samples()
{
  std::vector<Tensor<Dim>> all;
  const Tensor<Dim> one = Tensor<Dim>::Identity();
  for (int k = 0; k < 6; ++k)
    for (const double size : {1e-6, 1e-2, 0.3})
      for (const double angle : {0.0, 0.8, 3.0}) all.push_back(turned<Dim>(angle) * (one + some<Dim>(k, size)) - one);
  return all;
}

template <class L, int D> struct Case {
  using Law = L;
  static constexpr int kDim = D;
};
template <class C> struct SolidLaw : ::testing::Test {
  static std::vector<typename C::Law> laws()
  {
    if (C::kDim == 3) return {typename C::Law(solid())};
    return {typename C::Law(solid(Plane::stress)), typename C::Law(solid(Plane::strain))};
  }
};
using Cases =
    ::testing::Types<Case<Corotational<2>, 2>, Case<Corotational<3>, 3>, Case<NeoHooke<2>, 2>, Case<NeoHooke<3>, 3>>;
TYPED_TEST_SUITE(SolidLaw, Cases);

TYPED_TEST(SolidLaw, StressIsTheDerivativeOfTheEnergy)
{
  constexpr int Dim = TypeParam::kDim;
  const double step = 1e-4;
  for (const auto& law : this->laws())
    for (const Tensor<Dim>& h : samples<Dim>()) {
      const Tensor<Dim> p = stress<Dim>(law, h);
      for (int c = 0; c < Dim * Dim; ++c) {
        const auto at = [&](double by) {
          Tensor<Dim> moved = h;
          moved(c / Dim, c % Dim) += by * step;
          return energy<Dim>(law, moved);
        };
        const double slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
        EXPECT_NEAR(p(c / Dim, c % Dim), slope, 2e-10 * 10.0);
      }
    }
}

TYPED_TEST(SolidLaw, TangentIsTheDerivativeOfTheStressAndSymmetric)
{
  constexpr int Dim = TypeParam::kDim;
  const double step = 1e-4;
  for (const auto& law : this->laws())
    for (const Tensor<Dim>& h : samples<Dim>()) {
      const Tangent<Dim> a = law.tangent(h);
      EXPECT_LT((a - a.transpose()).norm(), 1e-13 * a.norm());
      for (int c = 0; c < Dim * Dim; ++c) {
        const auto at = [&](double by) {
          Tensor<Dim> moved = h;
          moved(c / Dim, c % Dim) += by * step;
          return stress<Dim>(law, moved);
        };
        const Tensor<Dim> slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
        for (int r = 0; r < Dim * Dim; ++r) EXPECT_NEAR(a(r, c), slope(r / Dim, r % Dim), 1e-9 * a.norm());
      }
    }
}

TYPED_TEST(SolidLaw, TurningTheBodyTurnsItsStress)
{
  constexpr int Dim = TypeParam::kDim;
  const Tensor<Dim> one = Tensor<Dim>::Identity();
  for (const auto& law : this->laws()) {
    for (const double angle : {0.3, 1.6, 3.1, -2.0}) {
      const Tensor<Dim> r = turned<Dim>(angle);
      EXPECT_LT(stress<Dim>(law, r - one).norm(), 1e-14 * 10.0) << "rigid";
      for (const Tensor<Dim>& h : samples<Dim>()) {
        const Tensor<Dim> moved = r * (one + h) - one;
        EXPECT_LT((stress<Dim>(law, moved) - r * stress<Dim>(law, h)).norm(), 1e-13 * 10.0);
        EXPECT_NEAR(energy<Dim>(law, moved), energy<Dim>(law, h), 1e-13 * 10.0);
      }
    }
    for (const Tensor<Dim>& h : samples<Dim>()) { // P F^T is Cauchy's stress times J: symmetric
      const Tensor<Dim> k = stress<Dim>(law, h) * (one + h).transpose();
      EXPECT_LT((k - k.transpose()).norm(), 1e-14 * 10.0 * (1.0 + h.norm()));
    }
  }
}

TYPED_TEST(SolidLaw, SmallStrainIsHookesLawToRounding)
{
  constexpr int Dim = TypeParam::kDim;
  for (const Plane plane : {Plane::stress, Plane::strain}) {
    const Elastic e = solid(plane);
    const typename TypeParam::Law law(e);
    const double lambda = Dim == 2 ? e.lambda() : solid_lambda(e);
    for (int k = 0; k < 4; ++k) {
      const Tensor<Dim> h = some<Dim>(k, 1e-9);
      const Tensor<Dim> strain = 0.5 * (h + h.transpose());
      const Tensor<Dim> hooke = lambda * strain.trace() * Tensor<Dim>::Identity() + 2.0 * e.mu() * strain;
      EXPECT_LT((stress<Dim>(law, h) - hooke).norm(), 2e-8 * hooke.norm()); // of second order
      const double half = 0.5 * hooke.cwiseProduct(h).sum();
      EXPECT_NEAR(energy<Dim>(law, h), half, 2e-8 * half);
    }
    const Tangent<Dim> a = law.tangent(Tensor<Dim>::Zero());
    EXPECT_NEAR(a(0, 0), lambda + 2.0 * e.mu(), 1e-13 * 10.0);
    EXPECT_NEAR(a(0, Dim + 1), lambda, 1e-13 * 10.0);
    EXPECT_NEAR(a(1, 1), e.mu(), 1e-13 * 10.0);
    EXPECT_NEAR(law.wave_speed(Tensor<Dim>::Zero()), std::sqrt((lambda + 2.0 * e.mu()) / kDensity), 1e-14);
  }
}

TYPED_TEST(SolidLaw, WaveSpeedIsThatOfTheFastestDirection)
{
  constexpr int Dim = TypeParam::kDim;
  for (const auto& law : this->laws())
    for (const double size : {0.05, 0.3, 1.2}) {
      const Tensor<Dim> stretch = Tensor<Dim>::Identity() * (1.0 + size) + 0.3 * some<Dim>(2, 0.3);
      const Tensor<Dim> h = turned<Dim>(0.7) * stretch - Tensor<Dim>::Identity();
      const Tangent<Dim> a = law.tangent(h);
      double most = 0.0;
      const int turns = Dim == 2 ? 1 : 300;
      for (int p = 0; p < 300; ++p)
        for (int q = 0; q < turns; ++q) {
          const double one = 3.14159265 * p / 300.0, two = 3.14159265 * q / turns;
          Vector<Dim> n;
          n[0] = std::cos(one) * (Dim == 3 ? std::cos(two) : 1.0);
          n[1] = std::sin(one) * (Dim == 3 ? std::cos(two) : 1.0);
          if constexpr (Dim == 3) n[2] = std::sin(two);
          Tensor<Dim> acoustic = Tensor<Dim>::Zero();
          for (int i = 0; i < Dim; ++i)
            for (int k = 0; k < Dim; ++k)
              for (int j = 0; j < Dim; ++j)
                for (int l = 0; l < Dim; ++l) acoustic(i, k) += a(i * Dim + j, k * Dim + l) * n[j] * n[l];
          most = std::max(most, Eigen::SelfAdjointEigenSolver<Tensor<Dim>>(acoustic).eigenvalues()[Dim - 1]);
        }
      EXPECT_NEAR(law.wave_speed(h), std::sqrt(most / kDensity), 1e-4 * std::sqrt(most / kDensity));
    }
}

TYPED_TEST(SolidLaw, LanesAgreeWithOneNumber)
{
  constexpr int Dim = TypeParam::kDim, W = 2;
  const auto all = samples<Dim>();
  for (const auto& law : this->laws())
    for (std::size_t k = 0; k + W <= all.size(); ++k) {
      Lanes<W> h[Dim][Dim], p[Dim][Dim];
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j)
          for (int l = 0; l < W; ++l) h[i][j][l] = all[k + static_cast<std::size_t>(l)](i, j);
      law.stress(h, p);
      const Lanes<W> density = law.energy(h);
      for (int l = 0; l < W; ++l) {
        const Tensor<Dim>& own = all[k + static_cast<std::size_t>(l)];
        const Tensor<Dim> expected = stress<Dim>(law, own);
        for (int i = 0; i < Dim; ++i)
          for (int j = 0; j < Dim; ++j) EXPECT_NEAR(p[i][j][l], expected(i, j), 1e-13 * 10.0);
        EXPECT_NEAR(density[l], energy<Dim>(law, own), 1e-13 * 10.0);
      }
    }
}

/// What lanes without a point hold is whatever was there before: runs repeat to the last bit only if it does not
/// matter.
TYPED_TEST(SolidLaw, LaneDoesNotSeeTheOthers)
{
  constexpr int Dim = TypeParam::kDim, W = 2;
  std::vector<Tensor<Dim>> all = samples<Dim>();
  all.push_back(Tensor<Dim>::Constant(std::numeric_limits<double>::quiet_NaN()));
  all.push_back(Tensor<Dim>::Constant(1e200));
  using Numbers = std::array<double, Dim * Dim + 1>;
  for (const auto& law : this->laws()) {
    const auto beside = [&](const Tensor<Dim>& own, const Tensor<Dim>& other) {
      Lanes<W> h[Dim][Dim], p[Dim][Dim];
      for (int i = 0; i < Dim * Dim; ++i)
        h[i / Dim][i % Dim] = Lanes<W>{own(i / Dim, i % Dim), other(i / Dim, i % Dim)};
      law.stress(h, p);
      Numbers numbers{law.energy(h)[0]};
      for (int i = 0; i < Dim * Dim; ++i) numbers[static_cast<std::size_t>(i) + 1] = p[i / Dim][i % Dim][0];
      return numbers;
    };
    for (std::size_t k = 0; k + 2 < all.size(); ++k) {
      const Numbers alone = beside(all[k], all[k]);
      for (const Tensor<Dim>& other : all) EXPECT_EQ(beside(all[k], other), alone) << k;
    }
  }
}

TEST(Corotational, PulledBarIsLinearInItsStretch)
{
  // F = diag(1 + a, 1 - nu a): plane stress, no side stress, P = E a.
  Tensor<2> h = Tensor<2>::Zero();
  h.diagonal() << 0.4, -0.12;
  const Tensor<2> p = stress<2>(Corotational<2>(solid()), h);
  EXPECT_NEAR(p(0, 0), 4.0, 1e-14);
  EXPECT_NEAR(p(1, 1), 0.0, 1e-14);
  Tensor<3> in_space = Tensor<3>::Zero();
  in_space.diagonal() << 0.4, -0.12, -0.12;
  const Tensor<3> of_space = stress<3>(Corotational<3>(solid()), in_space);
  EXPECT_NEAR(of_space(0, 0), 4.0, 1e-13);
  EXPECT_LT(of_space.bottomRightCorner(2, 2).norm(), 1e-13);
}

TEST(Corotational, PolarDecompositionHoldsFarFromRest)
{
  for (const double a : {0.01, 0.2, 1.0, 6.0})
    for (const double b : {0.05, 1.0, 3.0}) {
      const Tensor<3> turn = turned<3>(2.5), frame = turned<3>(0.9);
      const Vector<3> stretches(a, b, 1.7);
      const Tensor<3> u = frame * stretches.asDiagonal() * frame.transpose();
      const Tensor<3> h = turn * u - Tensor<3>::Identity();
      double from[3][3], lack[3][3], growth;
      for (int i = 0; i < 9; ++i) from[i / 3][i % 3] = h(i / 3, i % 3);
      rotate(from, lack, growth);
      EXPECT_NEAR(growth, stretches.sum() - 3.0, 1e-13 * stretches.sum());
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR((i % 4 == 0) - lack[i / 3][i % 3], turn(i / 3, i % 3), 1e-11) << a << ' ' << b;
    }
}

TEST(NeoHooke, PlaneStressIsTheSolidWithAFreeFace)
{
  const NeoHooke<2> plate(solid(Plane::stress));
  const NeoHooke<3> space(solid());
  for (const double a : {-0.4, -1e-3, 0.02, 0.5, 3.0}) {
    Tensor<2> h;
    h << a, 0.2, -0.1, 0.3 * a;
    Tensor<3> in_space = Tensor<3>::Zero();
    in_space.topLeftCorner<2, 2>() = h;
    double low = -0.95, high = 5.0; // of the stretch out of the plane, less 1
    for (int k = 0; k < 200; ++k) {
      in_space(2, 2) = 0.5 * (low + high);
      (stress<3>(space, in_space)(2, 2) > 0.0 ? high : low) = in_space(2, 2);
    }
    EXPECT_LT((stress<3>(space, in_space).topLeftCorner<2, 2>() - stress<2>(plate, h)).norm(), 1e-12 * 10.0);
    EXPECT_NEAR(energy<3>(space, in_space), energy<2>(plate, h), 1e-12 * 10.0);
  }
}

TEST(NeoHooke, SwollenBodyHasThePressureOfTheClosedForm)
{
  // F = l I: P = mu (l - 1/l) + 3 lambda ln l / l
  const double l = 1.3;
  const Tensor<3> p = stress<3>(NeoHooke<3>(solid()), (l - 1.0) * Tensor<3>::Identity());
  const double mu = 10.0 / 2.6, lambda = 10.0 * 0.3 / (1.3 * 0.4);
  EXPECT_NEAR(p(1, 1), mu * (l - 1.0 / l) + 3.0 * lambda * std::log(l) / l, 1e-13 * 10.0);
  EXPECT_NEAR(p(0, 1), 0.0, 1e-15);
}
} // namespace test_solid_law
