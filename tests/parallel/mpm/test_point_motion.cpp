#include "support/point_body.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

using namespace pdx;
using mpm::BodyMaterial;

namespace test_point_motion {
constexpr double kPi = std::numbers::pi;

BodyMaterial material(int ratio, double spacing)
{
  return {{10.0, 0.3, law::Plane::strain, 0.7, 4.0}, mpm::Law::corotational, spacing, ratio};
}
template <int Dim> Site<Dim> box(Index a, Index b)
{
  Site<Dim> cells;
  cells.fill(b);
  cells[0] = a;
  return cells;
}

/// Central differences of the nodes, whose velocities are half a step behind. Held components have no velocity.
template <int Dim> struct Motion {
  const test::PointBody<Dim>& body;
  std::vector<double> u, v, mass;
  std::vector<std::uint8_t> held;

  Motion(const test::PointBody<Dim>& b, const typename test::PointBody<Dim>::Field& displacement,
         const typename test::PointBody<Dim>::Field& velocity)
      : body(b), u(b.blocks(displacement)), v(b.blocks(velocity)), mass(b.mass())
  {
    v.resize(mass.size() * Dim);
    held.assign(v.size(), 0);
  }
  void step(double dt, double share = 1.0)
  {
    body.halo().refresh(u);
    const std::vector<double> force = body.force(u);
    for (std::size_t i = 0; i < v.size(); ++i) {
      v[i] = held[i] ? 0.0 : v[i] - share * dt * force[i] / mass[i / Dim];
      u[i] += dt * v[i];
    }
  }
};

/// Error of a standing pressure wave u = grad of cos(pi x) cos(pi y) (cos(pi z)) in a box of side 1 between rollers,
/// after 0.4 crossings, over its size at the start.
template <int Dim> double wave_error(Index cells, int ratio)
{
  const BodyMaterial m = material(ratio, 1.0 / cells / ratio);
  const test::PointBody<Dim> body(PETSC_COMM_WORLD, box<Dim>(cells, cells), m);
  const double speed = law::Corotational<Dim>(m.elastic).wave_speed(Tensor<Dim>::Zero()), small = 1e-7;
  const double omega = kPi * speed * std::sqrt(double{Dim});
  const auto shape = [&](const Vector<Dim>& x) -> Vector<Dim> {
    Vector<Dim> u;
    for (int d = 0; d < Dim; ++d) {
      u[d] = -small * std::sin(kPi * x[d]);
      for (int e = 0; e < Dim; ++e)
        if (e != d) u[d] *= std::cos(kPi * x[e]);
    }
    return u;
  };
  Motion<Dim> motion(body, shape, [](const Vector<Dim>&) -> Vector<Dim> { return Vector<Dim>::Zero(); });
  for (std::size_t i = 0; i < motion.held.size(); ++i) {
    const double x = body.nodes()[i / Dim][static_cast<Eigen::Index>(i % Dim)];
    motion.held[i] = x < 1e-9 || x > 1.0 - 1e-9;
  }
  const double end = 0.4 / speed;
  const int steps = 2 * cells;
  for (int k = 0; k < steps; ++k) motion.step(end / steps, k == 0 ? 0.5 : 1.0);
  double error = 0.0, size = 0.0;
  for (std::size_t n = 0; n < motion.mass.size(); ++n)
    for (int d = 0; d < Dim; ++d) {
      const double at_start = shape(body.nodes()[n])[d];
      const double off = motion.u[n * Dim + static_cast<std::size_t>(d)] - std::cos(omega * end) * at_start;
      error += motion.mass[n] * off * off;
      size += motion.mass[n] * at_start * at_start;
    }
  return std::sqrt(test::sum(error) / test::sum(size));
}

std::uint64_t round_mask(const Site<2>& cell)
{
  std::uint64_t mask = 0;
  for (int site = 0; site < 4; ++site)
    if ((mpm::site_place<2>(2, site) + Vector<2>(cell[0] - 5.0, cell[1] - 5.0)).norm() < 5.0)
      mask |= std::uint64_t{1} << site;
  return mask;
}

TEST(PointMotion, StandingWavesAreOfSecondOrder)
{
  for (const int ratio : {1, 2, 3}) {
    const double coarse = wave_error<2>(8, ratio), fine = wave_error<2>(16, ratio);
    EXPECT_NEAR(coarse / fine, 4.0, 0.25) << ratio;
    EXPECT_LT(fine, 0.02) << ratio;
  }
  const double coarse = wave_error<3>(4, 2), fine = wave_error<3>(8, 2);
  EXPECT_NEAR(coarse / fine, 4.0, 0.6);
  EXPECT_LT(fine, 0.07);
}

TEST(PointMotion, FlyingSpinningDiscKeepsMomentaAndEnergy)
{
  const BodyMaterial m = material(2, 0.1);
  const test::PointBody<2> body(PETSC_COMM_WORLD, {10, 10}, m, round_mask);
  const double speed = law::Corotational<2>(m.elastic).wave_speed(Tensor<2>::Zero());
  const auto velocity = [&](const Vector<2>& x) -> Vector<2> { // 3 % strain at the rim, and a wave
    return {0.3 * speed - 0.2 * speed * (x.y() - 1.0) + 0.02 * speed * std::sin(9.0 * x.x()),
            0.2 * speed * (x.x() - 1.0)};
  };
  Motion<2> motion(
      body, [](const Vector<2>&) -> Vector<2> { return Vector<2>::Zero(); }, velocity);
  const auto momenta = [&] {
    Vector<3> all = Vector<3>::Zero();
    for (std::size_t n = 0; n < motion.mass.size(); ++n) {
      const Vector<2> x = body.nodes()[n] + Vector<2>(motion.u[2 * n], motion.u[2 * n + 1]),
                      p = motion.mass[n] * Vector<2>(motion.v[2 * n], motion.v[2 * n + 1]);
      all += Vector<3>(p.x(), p.y(), x.x() * p.y() - x.y() * p.x());
    }
    for (double& value : all) value = test::sum(value);
    return all;
  };
  const auto kinetic = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < motion.v.size(); ++i) sum += 0.5 * motion.mass[i / 2] * motion.v[i] * motion.v[i];
    return test::sum(sum);
  };
  const Vector<3> first = momenta();
  const double before = kinetic(), dt = 0.5 * m.spacing / speed;
  double most = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double behind = kinetic();
    body.halo().refresh(motion.u);
    const double strain = test::sum(body.term().energy(motion.u));
    motion.step(dt, k == 0 ? 0.5 : 1.0);
    // Of the time of u: the mean of both halves' kinetic energy is right to second order.
    if (k > 0) most = std::max(most, std::abs(0.5 * (behind + kinetic()) + strain - before));
  }
  const Vector<3> last = momenta();
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(last[k], first[k], 1e-13 * first.norm());
  EXPECT_LT(most, 2e-3 * before);
  EXPECT_GT(motion.u[0], 30.0 * m.spacing); // has come a long way
}

TEST(PointMotion, ViscosityTakesWhatItSaysAndNothingOfRigidMotion)
{
  const test::PointBody<2> body(PETSC_COMM_WORLD, {10, 10}, material(2, 0.1), round_mask);
  const auto u = body.blocks([](const Vector<2>& x) -> Vector<2> {
    return {0.3 * x.y() + 0.02 * std::sin(4.0 * x.x()), 0.05 * std::cos(3.0 * x.y() + x.x())};
  });
  const auto force_of = [&](const std::vector<double>& v, double* power) {
    std::vector<double> r(body.nodes().size() * 2, 0.0);
    *power = test::sum(body.term().add_viscous(0.06, u, v, r));
    return r;
  };
  std::size_t at = 0; // spin about the origin of the body as it is displaced
  std::vector<double> spin(u.size());
  for (const Vector<2>& x : body.nodes()) {
    spin[at] = 1.0 - 2.0 * (x.y() + u[at + 1]);
    spin[at + 1] = 2.0 * (x.x() + u[at]);
    at += 2;
  }
  body.halo().refresh(spin);
  double power = 0.0;
  for (const double f : force_of(spin, &power)) EXPECT_NEAR(f, 0.0, 1e-13);
  EXPECT_NEAR(power, 0.0, 1e-13);
  const auto v = body.blocks([](const Vector<2>& x) -> Vector<2> { return {std::sin(3.0 * x.x()), x.y() * x.x()}; });
  const auto force = force_of(v, &power);
  double work = 0.0, sum[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < force.size(); ++i) {
    work += force[i] * v[i];
    sum[i % 2] += force[i];
  }
  EXPECT_GT(power, 0.1);
  EXPECT_NEAR(test::sum(work), power, 1e-13 * power);
  for (const double s : sum) EXPECT_NEAR(test::sum(s), 0.0, 1e-13);
}
} // namespace test_point_motion
