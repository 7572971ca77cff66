#include "pdx/base/error.hpp"
#include "pdx/pd/csr_part.hpp"
#include "pdx/pd/strip_part.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace pdx::test::csr_part {
using law::Kinematics;

namespace {
constexpr double kDx = 0.25;

law::Elastic elastic(int dim) { return {3.0, law::required_poisson(dim, law::Plane::stress), law::Plane::stress, 0.5}; }

/// A lattice in lane strips, and the same particles as a cloud; all on this rank.
template <int Dim> struct Both {
  geom::Lattice<Dim> lattice;
  pd::Cloud<Dim> cloud;
  std::unique_ptr<pd::LatticePart<Dim>> part;
  std::unique_ptr<pd::CsrPart<Dim>> list;
  std::vector<double> u;

  Both(const Site<Dim>& count, double ratio, law::Micromodulus micromodulus)
  {
    lattice.dx = kDx;
    lattice.count = count;
    const pd::StencilOptions options{kDx, 0.5, ratio * kDx, micromodulus, pd::Calibration::continuum, elastic(Dim)};
    std::vector<Index> sites;
    for (Index k = 0; k < lattice.total(); ++k) sites.push_back(k);
    const field::Rows rows = field::Rows::number(PETSC_COMM_SELF, 0, 0, 0, static_cast<Index>(sites.size()));
    part = std::make_unique<pd::LatticePart<Dim>>(rows, lattice, pd::make_stencil<Dim>(options), sites, 0,
                                                  pd::SurfaceCorrection<Dim>());
    for (const Index site : sites) {
      cloud.points.push_back(lattice.point(lattice.site(site)));
      cloud.volumes.push_back(part->stencil().volume());
    }
    list = std::make_unique<pd::CsrPart<Dim>>(cloud, static_cast<Index>(sites.size()),
                                              pd::CloudOptions{ratio * kDx, 0.5, micromodulus, elastic(Dim)});
    std::mt19937 random(5);
    std::uniform_real_distribution<double> chance(-1.0, 1.0);
    for (std::size_t k = 0; k < sites.size() * Dim; ++k) u.push_back(0.02 * kDx * chance(random));
  }
};

double largest(const std::vector<double>& x)
{
  double size = 0.0;
  for (const double v : x) size = std::max(size, std::abs(v));
  return size;
}
double apart(const std::vector<double>& x, const std::vector<double>& y)
{
  double worst = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) worst = std::max(worst, std::abs(x[k] - y[k]));
  return worst;
}

template <int Dim> void expect_lattice_answers(Both<Dim>& both, Kinematics kinematics)
{
  constexpr double s0 = 0.012;
  pd::StripPart<Dim> strip(*both.part, kinematics);
  strip.watch(s0);
  EXPECT_EQ(both.list->bonds(), 2 * both.part->bonds());
  for (const bool after : {false, true}) {
    std::vector<double> expected(both.u.size(), 0.0), list = expected, gathered = expected;
    strip.load(both.u);
    const double energy = strip.energy(expected.data());
    const pd::CsrSeen seen =
        pd::add_csr_force<Dim>(both.list->view(), kinematics, s0, both.u.data(), list.data(), true);
    EXPECT_LT(apart(list, expected), 2e-14 * largest(expected));
    EXPECT_NEAR(seen.energy, energy, 1e-13 * energy);
    EXPECT_EQ(seen.overstretched, !after);
    EXPECT_EQ(strip.overstretched_seen(), !after);
    for (const Processor processor : {Processor::any, Processor::avx2, Processor::avx512}) {
      if (processor > this_processor()) continue;
      std::fill(gathered.begin(), gathered.end(), 0.0);
      const pd::CsrSeen also = pd::add_gathered_force<Dim>(processor, both.list->view(), kinematics, s0, both.u.data(),
                                                           gathered.data(), true);
      EXPECT_LT(apart(gathered, list), 1e-14 * largest(list));
      EXPECT_NEAR(also.energy, energy, 1e-13 * energy);
      EXPECT_EQ(also.overstretched, !after);
    }
    const pd::Broken expected_broken = strip.break_bonds();
    const pd::Broken broken = both.list->break_bonds({kinematics, s0}, both.u);
    EXPECT_EQ(broken.bonds > 100, !after);
    EXPECT_EQ(broken.bonds, expected_broken.bonds);
    EXPECT_NEAR(broken.energy, expected_broken.energy, 1e-12 * expected_broken.energy);
    EXPECT_EQ(both.list->bonds(), 2 * both.part->bonds());
  }
}

TEST(CsrPart, GivesTheLatticesAnswers)
{
  for (const auto kinematics : {Kinematics::small, Kinematics::finite}) {
    Both<2> conical({40, 23}, 4.0, law::Micromodulus::conical);
    expect_lattice_answers(conical, kinematics);
    Both<2> uniform({40, 23}, 3.015, law::Micromodulus::uniform);
    expect_lattice_answers(uniform, kinematics);
    Both<3> solid({11, 9, 10}, 3.015, law::Micromodulus::uniform);
    expect_lattice_answers(solid, kinematics);
  }
}

/// Jittered particles of unequal volumes.
pd::Cloud<2> strewn()
{
  std::mt19937 random(9);
  std::uniform_real_distribution<double> chance(-0.3, 0.3);
  pd::Cloud<2> cloud;
  for (int j = 0; j < 17; ++j)
    for (int i = 0; i < 20; ++i) {
      cloud.points.push_back({kDx * (i + chance(random)), kDx * (j + chance(random))});
      cloud.volumes.push_back(0.5 * kDx * kDx * (1.0 + chance(random)));
    }
  return cloud;
}

TEST(CsrPart, BondsOfACloudAreThoseOfALoopOverPairs)
{
  const pd::Cloud<2> cloud = strewn();
  const double delta = 2.6 * kDx;
  const law::BondLaw<2> law(law::Micromodulus::conical, elastic(2), delta);
  const pd::CsrPart<2> part(cloud, static_cast<Index>(cloud.points.size()),
                            {delta, 0.5, law::Micromodulus::conical, elastic(2)});
  const pd::CsrView<2> view = part.view();
  std::int64_t b = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    for (std::size_t j = 0; j < cloud.points.size(); ++j) {
      const double length = (cloud.points[j] - cloud.points[i]).norm();
      if (i == j || length >= delta) continue;
      double beta = 0.0;
      for (const std::size_t end : {i, j}) {
        const double size = std::sqrt(cloud.volumes[end] / 0.5);
        beta += 0.5 * std::clamp((delta + 0.5 * size - length) / size, 0.0, 1.0);
      }
      ASSERT_LT(b, view.first[i + 1]);
      ASSERT_EQ(view.neighbour[b], static_cast<std::int32_t>(j));
      const double kappa = law.constant(length) * beta * cloud.volumes[i] * cloud.volumes[j];
      ASSERT_NEAR(view.weight[b], kappa / length, 1e-12 * kappa / length);
      ++b;
    }
  EXPECT_EQ(b, view.first.back());
}

TEST(CsrPart, ForcesOfACloudAreInBalance)
{
  const pd::Cloud<2> cloud = strewn();
  const pd::CsrPart<2> part(cloud, static_cast<Index>(cloud.points.size()),
                            {3.0 * kDx, 0.5, law::Micromodulus::uniform, elastic(2)});
  std::vector<double> u, r(2 * cloud.points.size(), 0.0);
  for (const Vector<2>& x : cloud.points) u.insert(u.end(), {0.01 * std::sin(3.0 * x[1]), 0.02 * std::cos(2.0 * x[0])});
  part.add_force(Kinematics::finite, 1.0, u, r);
  double x = 0.0, y = 0.0, turn = 0.0;
  for (std::size_t k = 0; k < cloud.points.size(); ++k) {
    x += r[2 * k];
    y += r[2 * k + 1];
    turn += (cloud.points[k][0] + u[2 * k]) * r[2 * k + 1] - (cloud.points[k][1] + u[2 * k + 1]) * r[2 * k];
  }
  EXPECT_GT(largest(r), 1e-4);
  EXPECT_NEAR(x, 0.0, 1e-13 * largest(r));
  EXPECT_NEAR(y, 0.0, 1e-13 * largest(r));
  EXPECT_NEAR(turn, 0.0, 1e-12 * largest(r));
}

TEST(CsrPart, PartsCountEachBondOnce)
{
  const pd::Cloud<2> cloud = strewn();
  const pd::CloudOptions options{3.0 * kDx, 0.5, law::Micromodulus::conical, elastic(2)};
  const std::size_t n = cloud.points.size(), half = n / 2;
  pd::Cloud<2> turned; // the second half first
  for (std::size_t k = 0; k < n; ++k) {
    turned.points.push_back(cloud.points[(k + half) % n]);
    turned.volumes.push_back(cloud.volumes[(k + half) % n]);
  }
  pd::CsrPart<2> whole(cloud, static_cast<Index>(n), options), front(cloud, static_cast<Index>(half), options),
      back(turned, static_cast<Index>(n - half), options);
  std::vector<double> u, other;
  for (const Vector<2>& x : cloud.points) u.insert(u.end(), {0.03 * std::sin(7.0 * x[0]), 0.02 * std::cos(9.0 * x[0])});
  for (const Vector<2>& x : turned.points)
    other.insert(other.end(), {0.03 * std::sin(7.0 * x[0]), 0.02 * std::cos(9.0 * x[0])});
  const pd::BreakRule rule{Kinematics::finite, 0.05};
  const pd::Broken all = whole.break_bonds(rule, u), first = front.break_bonds(rule, u),
                   second = back.break_bonds(rule, other);
  EXPECT_GT(all.bonds, 100);
  EXPECT_GT(std::min(first.bonds, second.bonds), 10);
  EXPECT_EQ(first.bonds + second.bonds, all.bonds);
  EXPECT_NEAR(first.energy + second.energy, all.energy, 1e-12 * all.energy);
  EXPECT_EQ(front.bonds() + back.bonds(), whole.bonds());
}

TEST(CsrPart, RefusesWhatMakesNoBonds)
{
  pd::Cloud<2> cloud = strewn();
  const auto make = [&](double horizon, double thickness) {
    pd::CsrPart<2>(cloud, static_cast<Index>(cloud.points.size()),
                   {horizon, thickness, law::Micromodulus::conical, elastic(2)});
  };
  EXPECT_THROW(make(0.0, 0.5), UserError);
  EXPECT_THROW(make(1e-3, 0.5), UserError);
  EXPECT_THROW(make(1.0, 0.4), UserError);
  cloud.points[7] = cloud.points[3];
  EXPECT_THROW(make(1.0, 0.5), UserError);
}
} // namespace
} // namespace pdx::test::csr_part
