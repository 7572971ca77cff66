// What must hold of bond forces whatever the implementation: rest, rigid motion, momentum, energy and tangent.
#include "window.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>

namespace {
using namespace pdx;
using law::Kinematics;
using test::at;
using test::Window;
using Rows = std::vector<double>;

const Window<2>& plate()
{
  static const Window<2> window({40, 14}, {.ratio = 3.015, .missing = 0.1, .broken = 0.2, .factors = true});
  return window;
}
const Window<3>& solid()
{
  static const Window<3> window({24, 8, 7}, {.ratio = 3.0, .missing = 0.1, .broken = 0.2});
  return window;
}
template <class Body> void in_plate_and_solid(Body body)
{
  body(plate());
  body(solid());
}

template <int Dim> Rows force(const Window<Dim>& window, const Rows& u, Kinematics kinematics)
{
  const auto spread = window.spread(u);
  Rows r(u.size());
  pd::add_force<Dim>(window.view(spread), window.runs, kinematics, r.data());
  return r;
}
template <int Dim> double energy(const Window<Dim>& window, const Rows& u, Kinematics kinematics)
{
  const auto spread = window.spread(u);
  Rows w(u.size() / Dim);
  pd::add_energy_density<Dim>(window.view(spread), window.runs, kinematics, window.volume(), w.data());
  return std::accumulate(w.begin(), w.end(), 0.0) * window.volume();
}
/// Tangent of the kinematics at u times x.
template <int Dim> Rows tangent_action(const Window<Dim>& window, const Rows& u, const Rows& x, Kinematics kinematics)
{
  const auto at_u = window.spread(u), at_x = window.spread(x);
  const auto view = window.view(at_u), along = window.view(at_x);
  Rows y(u.size()), d(u.size() * Dim);
  if (kinematics == Kinematics::finite) {
    pd::subtract_neighbours_finite<Dim>(view, along.u, window.runs, y.data());
    pd::diagonal_blocks_finite<Dim>(view, window.runs, d.data());
  } else {
    pd::subtract_neighbours<Dim>(along, window.runs, y.data());
    pd::diagonal_blocks<Dim>(along, window.runs, d.data());
  }
  for (Index r = 0; r < window.rows(); ++r)
    at<Dim>(y, r) += Eigen::Map<const Tensor<Dim>>(&d[r * Dim * Dim]) * at<Dim>(x, r);
  return y;
}
Rows moved(const Rows& u, double step, const Rows& x)
{
  Rows v = u;
  for (std::size_t k = 0; k < v.size(); ++k) v[k] += step * x[k];
  return v;
}
double largest(const Rows& x)
{
  double m = 0.0;
  for (const double v : x)
    if (!(std::abs(v) <= m)) m = std::abs(v); // lets NaN through
  return m;
}
double dot(const Rows& a, const Rows& b) { return std::inner_product(a.begin(), a.end(), b.begin(), 0.0); }
double difference(const Rows& a, const Rows& b) { return largest(moved(a, -1.0, b)); }

TEST(BondForce, IsZeroAtRestAndUnderTranslation)
{
  in_plate_and_solid([]<int Dim>(const Window<Dim>& window) {
    for (const double shift : {0.0, 0.3 * window.kDx}) {
      const Rows u(static_cast<std::size_t>(window.rows()) * Dim, shift);
      for (const auto kinematics : {Kinematics::finite, Kinematics::small}) {
        EXPECT_EQ(largest(force(window, u, kinematics)), 0.0);
        EXPECT_EQ(energy(window, u, kinematics), 0.0);
      }
    }
  });
}

template <int Dim> Rows turned(const Window<Dim>& window, const Tensor<Dim>& gradient)
{
  Rows u(static_cast<std::size_t>(window.rows()) * Dim);
  for (Index r = 0; r < window.rows(); ++r)
    at<Dim>(u, r) = gradient * window.sites.point(window.sites.site(window.particles[r]));
  return u;
}
TEST(BondForce, FiniteIsZeroUnderRotationAndLinearUnderSpin)
{
  const double kappa2 = plate().arms[0].kappa, kappa3 = solid().arms[0].kappa;
  const Tensor<2> turn = Eigen::Rotation2Dd(0.7).toRotationMatrix();
  EXPECT_LT(largest(force<2>(plate(), turned<2>(plate(), turn - Tensor<2>::Identity()), Kinematics::finite)),
            1e-12 * kappa2);
  const Tensor<3> roll = Eigen::AngleAxisd(0.7, Vector<3>(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT(largest(force<3>(solid(), turned<3>(solid(), roll - Tensor<3>::Identity()), Kinematics::finite)),
            1e-12 * kappa3);
  Tensor<2> spin;
  spin << 0.0, -0.1, 0.1, 0.0;
  EXPECT_LT(largest(force<2>(plate(), turned<2>(plate(), spin), Kinematics::small)), 1e-12 * kappa2);
  EXPECT_GT(largest(force<2>(plate(), turned<2>(plate(), spin), Kinematics::finite)), 1e-4 * kappa2);
}

TEST(BondForce, KeepsMomentumAndAngularMomentum)
{
  in_plate_and_solid([]<int Dim>(const Window<Dim>& window) {
    const Rows u = window.random_vector(0.2 * window.kDx, 7), r = force(window, u, Kinematics::finite);
    Vector<Dim> sum = Vector<Dim>::Zero();
    double moment = 0.0;
    for (Index k = 0; k < window.rows(); ++k) {
      const Vector<Dim> f = at<Dim>(r, k);
      const Vector<Dim> x = window.sites.point(window.sites.site(window.particles[k])) + at<Dim>(u, k);
      sum += f;
      moment += x[0] * f[1] - x[1] * f[0];
    }
    EXPECT_LT(sum.norm(), 1e-12 * largest(r));
    EXPECT_LT(std::abs(moment), 1e-11 * largest(r) * window.kDx);
  });
}

TEST(BondForce, IsTheGradientOfTheEnergy)
{
  in_plate_and_solid([]<int Dim>(const Window<Dim>& window) {
    const Rows u = window.random_vector(0.1 * window.kDx, 8), x = window.random_vector(window.kDx, 9);
    const double h = 1e-4;
    for (const auto kinematics : {Kinematics::finite, Kinematics::small}) {
      const double slope =
          (energy(window, moved(u, h, x), kinematics) - energy(window, moved(u, -h, x), kinematics)) / (2.0 * h);
      const Rows r = force(window, u, kinematics);
      EXPECT_NEAR(slope, dot(r, x), 1e-7 * std::sqrt(dot(r, r) * dot(x, x)));
      EXPECT_GT(energy(window, u, kinematics), 0.0);
    }
  });
}

TEST(BondTangent, IsTheDerivativeOfTheForce)
{
  in_plate_and_solid([]<int Dim>(const Window<Dim>& window) {
    const Rows u = window.random_vector(0.1 * window.kDx, 10), x = window.random_vector(window.kDx, 11);
    const double h = 1e-4;
    for (const auto kinematics : {Kinematics::finite, Kinematics::small}) {
      const Rows ahead = force(window, moved(u, h, x), kinematics), behind = force(window, moved(u, -h, x), kinematics);
      Rows slope(u.size());
      for (std::size_t k = 0; k < u.size(); ++k) slope[k] = (ahead[k] - behind[k]) / (2.0 * h);
      const Rows action = tangent_action(window, u, x, kinematics);
      EXPECT_LT(difference(slope, action), 1e-7 * largest(action));
    }
  });
}

TEST(BondTangent, FiniteAtRestIsTheLinearOne)
{
  in_plate_and_solid([]<int Dim>(const Window<Dim>& window) {
    const Rows x = window.random_vector(1.0, 12), rest(x.size());
    const Rows linear = tangent_action(window, rest, x, Kinematics::small);
    EXPECT_LT(difference(tangent_action(window, rest, x, Kinematics::finite), linear), 1e-13 * largest(linear));
  });
}

TEST(BondTangent, IsSymmetric)
{
  in_plate_and_solid([]<int Dim>(const Window<Dim>& window) {
    const Rows u = window.random_vector(0.2 * window.kDx, 13), x = window.random_vector(1.0, 14),
               y = window.random_vector(1.0, 15);
    const double xy = dot(tangent_action(window, u, x, Kinematics::finite), y);
    EXPECT_NEAR(xy, dot(tangent_action(window, u, y, Kinematics::finite), x),
                1e-12 * std::abs(xy) + 1e-13 * largest(u));
  });
}

/// Two particles joined by one bond along x in an otherwise empty window.
struct Couple {
  std::vector<double> ux = std::vector<double>(32), uy = ux;
  std::vector<std::uint64_t> bits = std::vector<std::uint64_t>(32), none = bits;
  pd::HalfArm<2> arm;
  pd::Run run{4, 0, 2, pd::RunKind::partial};
  explicit Couple(double length) : arm{1, {length, 0.0}, length, 3.0} { bits[4] = 1; }
  std::array<double, 4> force() const
  {
    std::array<double, 4> r{};
    pd::add_force<2>({{ux.data(), uy.data()}, {bits.data(), none.data()}, nullptr, nullptr, {&arm, 1}}, {&run, 1},
                     Kinematics::finite, r.data());
    return r;
  }
};

TEST(BondForce, OfOneBondIsKappaTimesStretchAtAnySize)
{
  for (const double length : {1e-9, 2.5e-5, 1.0, 1e6}) {
    Couple couple(length);
    couple.ux[5] = 0.5 * length;
    const auto r = couple.force();
    EXPECT_NEAR(r[0], -1.5, 3e-15); // 3 N times 1/2; a pull to the right is a negative internal force
    EXPECT_EQ(r[2], -r[0]);
    EXPECT_EQ(r[1], 0.0);
  }
}

TEST(BondForce, KeepsAllDigitsAtTinyStretch)
{
  Couple couple(1.0);
  couple.ux[5] = 1e-13;
  EXPECT_NEAR(couple.force()[0] / -3e-13, 1.0, 1e-15 * 4);
  couple.ux[5] = -1e-13;
  EXPECT_NEAR(couple.force()[0] / 3e-13, 1.0, 1e-15 * 4);
}

TEST(BondForce, OfABrokenBondIsExactlyZero)
{
  Couple couple(1.0);
  couple.ux[5] = -1.0; // the ends meet: no direction
  couple.bits[4] = 0;
  for (const double f : couple.force()) EXPECT_EQ(f, 0.0);
}
} // namespace
