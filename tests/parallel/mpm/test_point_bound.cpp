#include "pdx/base/symmetric.hpp"
#include "support/point_body.hpp"

#include <cmath>
#include <gtest/gtest.h>

using namespace pdx;
using mpm::BodyMaterial;

namespace test_point_bound {
BodyMaterial material(int ratio, double poisson = 0.3, double spacing = 0.05)
{
  return {{10.0, poisson, law::Plane::stress, 0.7, 4.0}, mpm::Law::corotational, spacing, ratio};
}
/// dx / c_L of points [s].
template <int Dim> double crossing(const BodyMaterial& m)
{
  return m.spacing / law::Corotational<Dim>(m.elastic).wave_speed(Tensor<Dim>::Zero());
}

/// Longest step by the bound, of all ranks [s].
template <int Dim> double bound(const test::PointBody<Dim>& body)
{
  const std::vector<double> mass = body.mass();
  std::vector<double> blocks(mass.size() * Dim * Dim, 0.0);
  body.term().add_stiffness_bound(blocks);
  double most = 0.0;
  for (std::size_t n = 0; n < mass.size(); ++n)
    for (int i = 0; i < Dim * Dim; ++i) {
      const double value = blocks[n * Dim * Dim + static_cast<std::size_t>(i)];
      if (i % (Dim + 1) == 0) {
        EXPECT_GT(value, 0.0);
        most = std::max(most, value / mass[n]);
      } else {
        EXPECT_EQ(value, 0.0);
      }
    }
  return 2.0 / std::sqrt(test::largest(most));
}

/// Longest step from all frequencies, on one rank [s].
template <int Dim> double truth(const test::PointBody<Dim>& body)
{
  const std::vector<double> mass = body.mass();
  const double tiny = 1e-9; // the force is linear
  const auto size = static_cast<Eigen::Index>(mass.size() * Dim);
  Eigen::MatrixXd k(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    std::vector<double> u(static_cast<std::size_t>(size), 0.0);
    u[static_cast<std::size_t>(j)] = tiny;
    const auto force = body.force(u);
    for (Eigen::Index i = 0; i < size; ++i)
      k(i, j) = force[static_cast<std::size_t>(i)] / tiny /
                std::sqrt(mass[static_cast<std::size_t>(i / Dim)] * mass[static_cast<std::size_t>(j / Dim)]);
  }
  return 2.0 / std::sqrt(symmetric_eigenvalues(0.5 * (k + k.transpose()))[size - 1]);
}

/// Sites whose centres are in a ball that fills n cells.
template <int Dim> typename test::PointBody<Dim>::Mask ball(int n, int ratio)
{
  return [=](const Site<Dim>& cell) {
    std::uint64_t mask = 0;
    for (int site = 0; site < std::popcount(mpm::full_mask<Dim>(ratio)); ++site) {
      Vector<Dim> place = mpm::site_place<Dim>(ratio, site);
      for (int d = 0; d < Dim; ++d) place[d] += cell[static_cast<std::size_t>(d)] - 0.5 * n;
      if (place.norm() < 0.5 * n) mask |= std::uint64_t{1} << site;
    }
    return mask;
  };
}
template <int Dim> Site<Dim> cube(Index n)
{
  Site<Dim> cells;
  cells.fill(n);
  return cells;
}

TEST(PointBound, EveryMaskAloneHasABoundedStep)
{
  // Few points make light nodes, but little stiffness too: the shortest step of a cell by itself is 13 % below that of
  // a full one.
  const BodyMaterial m = material(2);
  const double unit = crossing<2>(m), full = 2.0 / std::sqrt(1.3);
  for (std::uint64_t mask = 1; mask < 16; ++mask) {
    test::PointBody<2> cell(PETSC_COMM_SELF, {1, 1}, m, [=](const Site<2>&) { return mask; });
    const double step = bound(cell) / unit, limit = truth(cell) / unit;
    EXPECT_LE(step, limit * (1.0 + 1e-6)) << mask;
    EXPECT_GT(step, 0.86 * full) << mask;
    EXPECT_LT(limit, full + 1e-6) << mask;
    if (mask == 15) {
      EXPECT_NEAR(step, full, 1e-9);
    }
  }
}

TEST(PointBound, EveryMaskAtTheEdgeOfABodyHasABoundedStep)
{
  const BodyMaterial m = material(2);
  for (std::uint64_t mask = 1; mask < 16; ++mask) {
    test::PointBody<2> body(PETSC_COMM_SELF, {5, 4}, m,
                            [=](const Site<2>& c) { return c[1] == 3 && c[0] % 2 == 0 ? mask : 15; });
    const double step = bound(body) / crossing<2>(m), limit = truth(body) / crossing<2>(m);
    EXPECT_LE(step, limit * (1.0 + 1e-6)) << mask;
    EXPECT_GT(step, 0.9 * limit) << mask;
    EXPECT_GT(limit, 1.7) << mask;
  }
}

TEST(PointBound, IsBelowTheLongestStepAndClose)
{
  struct Case {
    int ratio, cells;
    bool round;
    double poisson, close;
  };
  for (const Case& c : {Case{1, 9, false, 0.3, 0.95}, Case{2, 9, false, 0.3, 0.95}, Case{2, 9, false, 0.0, 0.9999},
                        Case{2, 8, false, 0.45, 0.93}, Case{3, 7, false, 0.3, 0.95}, Case{2, 10, true, 0.3, 0.93},
                        Case{3, 8, true, 0.3, 0.93}}) {
    const BodyMaterial m = material(c.ratio, c.poisson);
    test::PointBody<2> body(PETSC_COMM_SELF, cube<2>(c.cells), m, c.round ? ball<2>(c.cells, c.ratio) : nullptr);
    const double step = bound(body), limit = truth(body);
    EXPECT_LE(step, limit * (1.0 + 1e-6));
    EXPECT_GT(step, c.close * limit) << c.ratio << ' ' << c.cells << ' ' << c.round;
    EXPECT_LT(limit, (1.0 + 1e-6) * c.ratio * crossing<2>(m)); // a body has no longer one than its waves allow
    EXPECT_GT(limit, 0.89 * c.ratio * crossing<2>(m));
  }
  for (const Case& c : {Case{2, 3, false, 0.3, 0.89}, Case{1, 4, false, 0.3, 0.89}, Case{2, 4, true, 0.3, 0.88}}) {
    const BodyMaterial m = material(c.ratio, c.poisson);
    test::PointBody<3> body(PETSC_COMM_SELF, cube<3>(c.cells), m, c.round ? ball<3>(c.cells, c.ratio) : nullptr);
    const double step = bound(body), limit = truth(body);
    EXPECT_LE(step, limit * (1.0 + 1e-6));
    EXPECT_GT(step, c.close * limit) << c.ratio << ' ' << c.cells << ' ' << c.round;
  }
}

TEST(PointBound, HoldsForAnyPoints)
{
  for (const int ratio : {2, 3}) {
    test::PointBody<2> plate(PETSC_COMM_SELF, {6, 5}, material(ratio),
                             [=](const Site<2>& cell) { return test::mixed_mask<2>(cell, ratio); });
    EXPECT_LE(bound(plate), truth(plate) * (1.0 + 1e-6));
    EXPECT_GT(bound(plate), 0.85 * truth(plate));
  }
  test::PointBody<3> block(PETSC_COMM_SELF, {3, 2, 2}, material(2),
                           [](const Site<3>& cell) { return test::mixed_mask<3>(cell, 2); });
  EXPECT_LE(bound(block), truth(block) * (1.0 + 1e-6));
}

TEST(PointBound, DoesNotDependOnWhoHasWhat)
{
  test::PointBody<2> alone(PETSC_COMM_SELF, cube<2>(12), material(2), ball<2>(12, 2)),
      body(PETSC_COMM_WORLD, cube<2>(12), material(2), ball<2>(12, 2));
  EXPECT_NEAR(bound(body) / test::largest(bound(alone)), 1.0, 1e-11);
  test::PointBody<3> ball_alone(PETSC_COMM_SELF, cube<3>(4), material(2), ball<3>(4, 2)),
      ball_here(PETSC_COMM_WORLD, cube<3>(4), material(2), ball<3>(4, 2));
  EXPECT_NEAR(bound(ball_here) / test::largest(bound(ball_alone)), 1.0, 1e-11);
}
} // namespace test_point_bound
