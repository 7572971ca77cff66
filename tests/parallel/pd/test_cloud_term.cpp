#include "pdx/base/error.hpp"
#include "pdx/couple/step_breaker.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/stable_step.hpp"
#include "support/ranks.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>
#include <random>

namespace pdx::test::cloud_term {
namespace {
using law::Kinematics;

constexpr double kDx = 0.25, kThickness = 0.5;
const auto go_on = [] { return solve::TimeDriver::Verdict::go_on; };

law::Elastic elastic(int dim)
{
  return {3.0, law::required_poisson(dim, law::Plane::stress), law::Plane::stress, kThickness, 0.7};
}
pd::CloudOptions options(int dim, double ratio, law::Micromodulus micromodulus = law::Micromodulus::conical)
{
  return {ratio * kDx, kThickness, micromodulus, elastic(dim)};
}

/// Points of a lattice, x fastest, each up to `jitter` spacings off it, with volumes that differ as much.
template <int Dim> pd::Cloud<Dim> strewn(const geom::Lattice<Dim>& lattice, double jitter)
{
  std::mt19937 random(9);
  std::uniform_real_distribution<double> chance(-jitter, jitter);
  pd::Cloud<Dim> cloud;
  for (Index k = 0; k < static_cast<Index>(lattice.total()); ++k) {
    Vector<Dim> x = lattice.point(lattice.site(k));
    for (double& entry : x) entry += kDx * chance(random);
    cloud.points.push_back(x);
    cloud.volumes.push_back((Dim == 2 ? kThickness : kDx) * kDx * kDx * (1.0 + chance(random)));
  }
  return cloud;
}

template <int Dim> geom::Lattice<Dim> lattice_of(const Site<Dim>& count)
{
  geom::Lattice<Dim> lattice;
  lattice.dx = kDx;
  lattice.count = count;
  return lattice;
}

/// Opens and shears, and has no symmetry.
template <int Dim> Vector<Dim> moved(const Vector<Dim>& x)
{
  Vector<Dim> u = Vector<Dim>::Zero();
  u[0] = 0.03 * std::sin(1.7 * x[0] + 0.4 * x[1]);
  u[1] = 0.02 * std::cos(2.3 * x[0]) + 0.01 * x[1];
  if constexpr (Dim == 3) u[2] = 0.02 * std::sin(1.1 * x[2] + x[0]);
  return u;
}

/// A cloud whose particles are dealt out in turns, so that everybody has neighbours everywhere, as a system to step.
template <int Dim> struct Dealt {
  pd::Cloud<Dim> cloud;
  std::vector<Index> mine;
  field::System system;
  pd::CloudTerm<Dim>* term;

  Dealt(MPI_Comm comm, pd::Cloud<Dim> given, const pd::CloudOptions& how, Kinematics kinematics)
      : cloud(std::move(given))
  {
    int here = 0, all = 1;
    MPI_Comm_rank(comm, &here);
    MPI_Comm_size(comm, &all);
    for (Index k = 0; k < static_cast<Index>(cloud.points.size()); ++k)
      if (k / 3 % all == here) mine.push_back(k);
    system.rows = field::Rows::number(comm, Dim, 0, 0, static_cast<Index>(mine.size()));
    for (const Index k : mine) system.coordinates.insert(system.coordinates.end(), at(k).begin(), at(k).end());
    auto bonds = std::make_unique<pd::CloudTerm<Dim>>(system.rows, cloud, mine, how, kinematics);
    term = bonds.get();
    system.terms.push_back(std::move(bonds));
    system.load.assign(mine.size() * Dim, 0.0);
    system.bind();
  }

  const Vector<Dim>& at(Index number) const { return cloud.points[static_cast<std::size_t>(number)]; }
  /// [owned | halo]
  std::vector<double> displacement() const
  {
    std::vector<double> owned, all;
    for (const Index k : mine) {
      const Vector<Dim> u = moved<Dim>(at(k));
      owned.insert(owned.end(), u.begin(), u.end());
    }
    system.halo->fetch(owned, Dim, all);
    return all;
  }
  std::vector<double> force(std::span<const double> u) const
  {
    std::vector<double> r(mine.size() * Dim, 0.0);
    term->add_residual(u, r);
    return r;
  }
};

/// Steps to `end` [s] in steps of 0.9 of the limit.
std::unique_ptr<solve::ExplicitDriver> stepped(field::System& system, const std::string& end)
{
  const test::Option to("-ts_max_time", end);
  auto driver = std::make_unique<solve::ExplicitDriver>(
      system, solve::ExplicitOptions{solve::stable_step(system).limit, 0.9, false});
  driver->run(go_on);
  return driver;
}

template <int Dim> void expect_near(std::span<const double> values, std::span<const double> expected, double tolerance)
{
  double largest = 0.0;
  for (const double x : expected) largest = std::max(largest, std::abs(x));
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t k = 0; k < values.size(); ++k) ASSERT_NEAR(values[k], expected[k], tolerance * largest) << k;
}

/// Against the bonds of a lattice: force, energy, mass, bound of the stiffness, and what breaks.
template <int Dim> void expect_lattice_answers(const Site<Dim>& count, Kinematics kinematics)
{
  const geom::Lattice<Dim> lattice = lattice_of<Dim>(count);
  const auto how = options(Dim, 3.0);
  Dealt<Dim> d(PETSC_COMM_WORLD, strewn<Dim>(lattice, 0.0), how, kinematics);
  std::vector<std::unique_ptr<pd::LatticePart<Dim>>> parts;
  parts.push_back(std::make_unique<pd::LatticePart<Dim>>(
      d.system.rows, lattice,
      pd::make_stencil<Dim>({kDx, kThickness, how.horizon, how.micromodulus, pd::Calibration::continuum, how.elastic}),
      d.mine, 0, pd::SurfaceCorrection<Dim>()));
  pd::BondTerm<Dim> reference(std::move(parts), kinematics, false);
  const field::RowHalo none(d.system.rows, {});
  reference.bind(none);
  const crack::CrackSet cracks({{{-1.0, 1.01}, {1.7, 1.13}}}, {{0.0, 0.0}, {kDx * count[0], kDx * count[1]}});
  EXPECT_EQ(sum(static_cast<double>(d.term->cut(cracks))), sum(static_cast<double>(reference.cut(cracks))));
  const std::vector<double> u = d.displacement();
  const std::span<const double> owned(u.data(), d.mine.size() * Dim);

  std::vector<double> mass(d.mine.size(), 0.0), expected_mass = mass;
  std::vector<double> blocks(d.mine.size() * Dim * Dim, 0.0), expected_blocks = blocks;
  d.term->add_mass(mass);
  reference.add_mass(expected_mass);
  expect_near<Dim>(mass, expected_mass, 1e-14);
  d.term->add_stiffness_bound(blocks);
  reference.add_stiffness_bound(expected_blocks);
  expect_near<Dim>(blocks, expected_blocks, 1e-13);

  constexpr double s0 = 0.02;
  const std::vector<geom::Box<2>> safe{{{0.0, 0.0}, {0.6, 0.6}}};
  reference.protect(safe);
  const pd::BreakRule rule{kinematics, s0};
  reference.step_explicitly({&rule, 1});
  couple::CloudBreaker<Dim> breaker(*d.term, s0, safe);
  for (const bool after : {false, true}) {
    std::vector<double> force(owned.size(), 0.0);
    reference.add_residual(owned, force);
    expect_near<Dim>(d.force(u), force, 1e-13);
    const double energy = sum(reference.energy(owned));
    EXPECT_NEAR(sum(d.term->energy(u)), energy, 1e-13 * energy);
    field::ForceLosses losses, unused;
    breaker.apply(u, losses);
    const pd::Broken broken = reference.break_overstretched(&unused);
    EXPECT_EQ(sum(static_cast<double>(broken.bonds)) > 100, !after);
    if (!after) {
      EXPECT_EQ(sum(static_cast<double>(breaker.mine().bonds)), sum(static_cast<double>(broken.bonds)));
      EXPECT_NEAR(sum(breaker.mine().energy) / sum(broken.energy), 1.0, 1e-12);
      for (const field::ForceLoss& loss : losses) force[static_cast<std::size_t>(loss.component)] -= loss.force;
      expect_near<Dim>(d.force(u), force, 1e-12);
    }
  }
  std::vector<pd::BondedVolume> volumes(d.mine.size());
  reference.add_bonded_volume(volumes);
  const std::vector<pd::BondedVolume> found = d.term->bonded_volume();
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    ASSERT_NEAR(found[k].start / volumes[k].start, 1.0, 1e-12);
    ASSERT_NEAR(pd::damage(found[k]), pd::damage(volumes[k]), 1e-12);
  }
  breaker.restore();
  EXPECT_EQ(breaker.mine().bonds, 0);
  for (const pd::BondedVolume& volume : d.term->bonded_volume()) ASSERT_EQ(volume.now, volume.start);
}

TEST(CloudTerm, GivesTheLatticesAnswersOnItsPoints)
{
  for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite}) {
    expect_lattice_answers<2>({17, 12}, kinematics);
    expect_lattice_answers<3>({9, 8, 7}, kinematics);
  }
}

template <int Dim> void expect_same_bits(const Site<Dim>& count)
{
  const pd::Cloud<Dim> cloud = strewn<Dim>(lattice_of<Dim>(count), 0.3);
  Dealt<Dim> here(PETSC_COMM_WORLD, cloud, options(Dim, 2.6), Kinematics::finite),
      alone(PETSC_COMM_SELF, cloud, options(Dim, 2.6), Kinematics::finite);
  const std::vector<double> u = here.displacement(), v = alone.displacement();
  EXPECT_EQ(here.term->words_per_particle(), alone.term->words_per_particle());
  for (const bool after : {false, true}) {
    const std::vector<double> force = here.force(u), expected = alone.force(v);
    const std::vector<std::uint64_t> words = here.term->gone(), all = alone.term->gone();
    const auto width = static_cast<std::size_t>(here.term->words_per_particle());
    for (std::size_t k = 0; k < here.mine.size(); ++k) {
      const auto number = static_cast<std::size_t>(here.mine[k]);
      for (std::size_t a = 0; a < Dim; ++a) ASSERT_EQ(force[Dim * k + a], expected[Dim * number + a]);
      for (std::size_t w = 0; w < width; ++w) ASSERT_EQ(words[width * k + w], all[width * number + w]);
    }
    if (after) break;
    field::ForceLosses losses;
    here.term->watch(0.02, {});
    alone.term->watch(0.02, {});
    EXPECT_GT(alone.term->break_overstretched(v, losses).bonds, 100);
    (void)here.term->break_overstretched(u, losses);
  }
}

TEST(CloudTerm, IsTheSameToTheLastBitOnAnyNumberOfRanks)
{
  expect_same_bits<2>({17, 12});
  expect_same_bits<3>({9, 8, 7}); // more than 64 bonds a particle
}

TEST(CloudTerm, TakesOverBrokenBondsFromWords)
{
  const pd::Cloud<3> cloud = strewn<3>(lattice_of<3>({9, 8, 7}), 0.3);
  Dealt<3> torn(PETSC_COMM_WORLD, cloud, options(3, 2.6), Kinematics::finite),
      whole(PETSC_COMM_WORLD, cloud, options(3, 2.6), Kinematics::finite);
  const std::vector<double> u = torn.displacement();
  field::ForceLosses losses;
  torn.term->watch(0.02, {});
  EXPECT_GT(sum(static_cast<double>(torn.term->break_overstretched(u, losses).bonds)), 100.0);
  EXPECT_EQ(torn.term->words_per_particle(), 2);
  EXPECT_GT(sum(torn.force(u) != whole.force(u)), 0.0);
  whole.term->set_gone(torn.term->gone());
  EXPECT_EQ(torn.force(u), whole.force(u));
}

TEST(CloudTerm, KeepsItsEnergy)
{
  Dealt<2> d(PETSC_COMM_WORLD, strewn<2>(lattice_of<2>({15, 11}), 0.3), options(2, 3.0), Kinematics::small);
  for (const Index k : d.mine) {
    const Vector<2> v = moved<2>(d.at(k));
    d.system.initial_velocity.insert(d.system.initial_velocity.end(), {v[0], v[1]});
  }
  const auto driver = stepped(d.system, "20");
  const solve::KineticEnergy kinetic = driver->kinetic_energy();
  const double stored = sum(d.term->energy(driver->local())), given = driver->clock().initial;
  EXPECT_GT(driver->step(), 50);
  EXPECT_GT(stored, 0.05 * given);
  EXPECT_NEAR((kinetic.moving - kinetic.scheme + stored) / given, 1.0, 1e-11);
}

TEST(CloudTerm, KeepsItsMomentumWhileBondsBreak)
{
  Dealt<2> d(PETSC_COMM_WORLD, strewn<2>(lattice_of<2>({15, 11}), 0.3), options(2, 3.0), Kinematics::finite);
  auto breaker = std::make_unique<couple::CloudBreaker<2>>(*d.term, 0.03, std::span<const geom::Box<2>>());
  const couple::CloudBreaker<2>& seen = *breaker;
  d.system.after_step.push_back(std::move(breaker));
  std::vector<double> mass(d.mine.size(), 0.0);
  d.term->add_mass(mass);
  const auto momentum = [&](std::span<const double> v) {
    std::array<double, 2> total{};
    for (std::size_t k = 0; k < v.size(); ++k) total[k % 2] += mass[k / 2] * v[k];
    return std::array{sum(total[0]), sum(total[1])};
  };
  for (const Index k : d.mine) {
    const Vector<2> v = 0.3 * (d.at(k) - Vector<2>(1.0, 1.0));
    d.system.initial_velocity.insert(d.system.initial_velocity.end(), {v[0], v[1]});
  }
  const auto before = momentum(d.system.initial_velocity);
  const auto driver = stepped(d.system, "2");
  const auto after = momentum(driver->v());
  EXPECT_GT(sum(static_cast<double>(seen.mine().bonds)), 100.0);
  for (std::size_t a = 0; a < 2; ++a) EXPECT_NEAR(after[a], before[a], 1e-13 * std::abs(before[0]));
}

TEST(CloudTerm, RefusesAlikeOnEveryRankWhatOneRankSees)
{
  pd::Cloud<2> cloud = strewn<2>(lattice_of<2>({15, 11}), 0.3);
  const auto message = [&](double ratio) -> std::string {
    try {
      const Dealt<2> d(PETSC_COMM_WORLD, cloud, options(2, ratio), Kinematics::small);
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(3.0), "");
  EXPECT_NE(message(0.2).find("no two of them are within the horizon of 0.05 m"), std::string::npos);
  cloud.points[7] = cloud.points[6]; // the same rank's on up to three ranks
  EXPECT_NE(message(3.0).find("numbers 7 and 8 are in one place"), std::string::npos);
}
} // namespace
} // namespace pdx::test::cloud_term
