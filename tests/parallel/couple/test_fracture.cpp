#include "pdx/base/gather.hpp"
#include "pdx/couple/fracture.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>
#include <map>

using namespace pdx;
using couple::Fracture;
using couple::FractureRule;
using couple::Release;
using couple::Scheme;

namespace {
options::SceneOptions plate(Scheme scheme = Scheme::energy,
                            options::KinematicsOption kinematics = options::KinematicsOption::small)
{
  auto options = test::with_patch(test::held_plate({10, 10}), {{0.2, 0.2}, {0.8, 0.8}}, 0.05);
  options.scheme = scheme;
  options.kinematics = kinematics;
  return options;
}

/// Opens across x = 0.5, most at mid height, the same on either side of both axes.
Vector<2> opening(const Vector<2>& x)
{
  const Vector<2> y = x - Vector<2>(0.5, 0.5);
  return {0.02 * std::tanh(5.0 * y.x()) * std::exp(-20.0 * y.y() * y.y()), 0.0};
}

/// Strains everything, the interface too.
Vector<2> wild(const Vector<2>& x) { return 4e-3 * test::noise(7)(x) + Vector<2>(0.03 * x.x(), 0.01 * x.y()); }

FractureRule all_above(double stretch, law::Kinematics kinematics = law::Kinematics::small)
{
  FractureRule options;
  options.critical_stretch = {stretch};
  options.kinematics = kinematics;
  return options;
}

/// Damage of all particles of all ranks by place, in numbers of sites.
std::map<std::pair<long, long>, double> damage_map(test::Scene& scene, double dx)
{
  struct Record {
    long x, y;
    double damage;
  };
  std::vector<Record> mine;
  const auto& d = scene.d();
  const couple::ParticleDamage damage = couple::particle_damage(scene.rows(), *d.bonds, d.carried);
  for (std::size_t k = 0; k < d.particles.size(); ++k)
    mine.push_back(
        {std::lround(d.particles[k].x.x() / dx - 0.5), std::lround(d.particles[k].x.y() / dx - 0.5), damage.damage[k]});
  std::map<std::pair<long, long>, double> all;
  for (const Record& r : gather_all(scene.mesh().comm(), mine)) all[{r.x, r.y}] = r.damage;
  return all;
}
} // namespace

// What the springs lose is what is said to be dissipated, and the force is still the gradient of the energy.
TEST(Fracture, DissipatedIsTheEnergyThatIsGone)
{
  for (const Scheme scheme : {Scheme::energy, Scheme::ghost})
    for (const auto kinematics : {options::KinematicsOption::small, options::KinematicsOption::mixed}) {
      test::Scene scene(plate(scheme, kinematics));
      const auto linear = kinematics == options::KinematicsOption::small;
      Fracture fracture(*scene.d().bonds, scene.d().carried,
                        all_above(0.06, linear ? law::Kinematics::small : law::Kinematics::finite));
      const auto u = scene.blocks(wild);
      const double before = scene.energy(u), carried = scene.sum(scene.d().carried->energy(u));
      const std::int64_t broken = fracture.apply(u);
      EXPECT_GT(broken, 100);
      EXPECT_EQ(fracture.broken(), broken);
      EXPECT_GT(carried, 1.001 * scene.sum(scene.d().carried->energy(u))); // some of those broke, too
      EXPECT_NEAR(fracture.dissipated(), before - scene.energy(u), 1e-12 * before);
      EXPECT_EQ(fracture.apply(u), 0); // quiet
      EXPECT_EQ(fracture.broken(), broken);

      const auto x = scene.blocks(test::noise(3));
      const auto force = scene.internal_force(u);
      double slope = 0.0;
      for (std::size_t k = 0; k < force.size(); ++k) slope += force[k] * x[k];
      const auto moved = [&](double by) {
        auto v = u;
        for (std::size_t k = 0; k < v.size(); ++k) v[k] += by * x[k];
        return scene.energy(v);
      };
      slope = scene.sum(slope);
      EXPECT_NEAR((moved(1e-5) - moved(-1e-5)) / 2e-5, slope, 1e-6 * std::abs(slope));
    }
}

TEST(Fracture, MatrixFreeAndAssembledForcesAreThoseOfTheSameBonds)
{
  test::Scene free(plate()), whole(plate(), true);
  std::vector<double> force[2];
  int number = 0;
  for (test::Scene* scene : {&free, &whole}) {
    scene->d().bonds->cut(crack::CrackSet({{{0.1, 0.5}, {0.52, 0.47}}}, geom::Box<2>{{0.0, 0.0}, {1.0, 1.0}}));
    Fracture fracture(*scene->d().bonds, scene->d().carried, all_above(0.06));
    const auto u = scene->blocks(wild);
    fracture.apply(u);
    force[number++] = scene->internal_force(u);
    EXPECT_GT(scene->max(scene->d().bonds->constant_jacobian()), 0.0);
  }
  EXPECT_EQ(force[0], force[1]);
}

TEST(Fracture, TheSameBondsBreakOnAnyNumberOfRanks)
{
  for (const Release release : {Release::all, Release::worst}) {
    const auto sample = [release](MPI_Comm comm, int what) {
      test::Scene scene(plate(), false, comm);
      FractureRule options = all_above(0.05);
      options.release = release;
      Fracture fracture(*scene.d().bonds, scene.d().carried, options);
      const auto u = scene.blocks(wild);
      fracture.apply(u);
      fracture.apply(u);
      if (what == 0) return static_cast<double>(fracture.broken());
      if (what == 1) return fracture.dissipated();
      double code = 0.0;
      for (const auto& [place, damage] : damage_map(scene, 0.05))
        code += damage * std::cos(static_cast<double>(3 * place.first + 7 * place.second * place.second));
      return code;
    };
    for (const int what : {0, 1, 2}) {
      const double alone = test::on_one_rank([&](MPI_Comm comm) { return sample(comm, what); });
      EXPECT_NEAR(sample(PETSC_COMM_WORLD, what), alone, what ? 1e-12 * std::abs(alone) : 0.0);
      EXPECT_NE(alone, 0.0);
    }
  }
}

// The share of bonds above which an increment is halved is one of all ranks' bonds.
TEST(Fracture, BondsAtTheStartAreThoseOfAllRanks)
{
  auto options = plate();
  options.fracture.critical_stretch = 0.05;
  const auto count = [&](MPI_Comm comm) {
    return static_cast<double>(test::Scene(options, false, comm).d().bonds_at_start);
  };
  EXPECT_EQ(count(PETSC_COMM_WORLD), test::on_one_rank(count));
}

TEST(Fracture, WorstBreaksTheMostStretchedAndTheirMirrorImages)
{
  test::Scene scene(plate());
  FractureRule options = all_above(0.02);
  options.release = Release::worst;
  options.release_share = 1e-6; // the one worst bond, and what is like it
  Fracture fracture(*scene.d().bonds, scene.d().carried, options);
  const auto u = scene.blocks(opening);
  std::int64_t before = 0;
  for (int pass = 0; pass < 4; ++pass) {
    const std::int64_t broken = fracture.apply(u);
    EXPECT_GE(broken, 2); // nothing lies on the axis y = 0.5, so nothing is its own image
    EXPECT_LE(broken, 4);
    before += broken;
    const auto damage = damage_map(scene, 0.05);
    double most = 0.0;
    for (const auto& [place, value] : damage) {
      EXPECT_NEAR(value, damage.at({19 - place.first, place.second}), 1e-14);
      EXPECT_NEAR(value, damage.at({place.first, 19 - place.second}), 1e-14);
      most = std::max(most, value);
    }
    EXPECT_GT(most, 0.0);
    if (pass == 0) { // the two short bonds across x = 0.5 nearest to the axis
      EXPECT_EQ(broken, 2);
      EXPECT_GT(damage.at({9, 9}), 0.0);
      EXPECT_GT(damage.at({10, 10}), 0.0);
    }
  }
  EXPECT_EQ(fracture.broken(), before);
}

TEST(Fracture, WorstBreaksItsShare)
{
  const auto broken = [](Release release, double share) {
    test::Scene scene(plate());
    FractureRule options = all_above(0.05);
    options.release = release;
    options.release_share = share;
    return Fracture(*scene.d().bonds, scene.d().carried, options).apply(scene.blocks(wild));
  };
  const std::int64_t all = broken(Release::all, 0.1);
  EXPECT_GT(all, 200);
  EXPECT_EQ(broken(Release::worst, 1.0), all);
  EXPECT_EQ(broken(Release::worst, 0.1), all / 10); // no two bonds of this field are alike
}

TEST(Fracture, RestoreGoesBackAsOftenAsAsked)
{
  test::Scene scene(plate(Scheme::energy, options::KinematicsOption::mixed));
  Fracture fracture(*scene.d().bonds, scene.d().carried, all_above(0.08, law::Kinematics::finite));
  const auto u = scene.blocks(wild), v = scene.blocks([](const Vector<2>&x) -> Vector<2> { return 1.3 * wild(x); });
  const auto start = scene.internal_force(u);
  fracture.apply(v);
  EXPECT_GT(fracture.broken(), 0);
  fracture.restore(); // the state at construction
  EXPECT_EQ(fracture.broken(), 0);
  EXPECT_EQ(fracture.dissipated(), 0.0);
  EXPECT_EQ(scene.internal_force(u), start);

  const std::int64_t first = fracture.apply(u);
  fracture.save();
  const double dissipated = fracture.dissipated();
  const auto saved = scene.internal_force(u);
  for (int again = 0; again < 2; ++again) {
    EXPECT_GT(fracture.apply(v), 0);
    fracture.restore();
    EXPECT_EQ(fracture.broken(), first);
    EXPECT_EQ(fracture.dissipated(), dissipated);
    EXPECT_EQ(scene.internal_force(u), saved);
  }
}

TEST(Fracture, BrokenBondsDoNotHeal)
{
  test::Scene scene(plate());
  Fracture fracture(*scene.d().bonds, scene.d().carried, all_above(0.05));
  const auto u = scene.blocks(wild);
  fracture.apply(u);
  const std::int64_t bonds = scene.d().bonds->bonds();
  const auto force = scene.internal_force(u);
  EXPECT_EQ(fracture.apply(scene.blocks(test::affine(0.0, 0.0, 0.0, 0.0))), 0);
  EXPECT_EQ(scene.d().bonds->bonds(), bonds);
  EXPECT_EQ(scene.internal_force(u), force);
}

// m = 4, conical: beta is 1 up to 3.5 dx and 4.5 - sqrt 13 at (3, 2) and its seven images, so that a whole family is 36
// + 8 (4.5 - sqrt 13), of which 6 are in the particle's own row and 6 + 2 (4.5 - sqrt 13) ... in the next one.
TEST(Fracture, DamageBesideAStraightCrackByHand)
{
  const double far = 4.5 - std::sqrt(13.0), family = 36.0 + 8.0 * far;
  const double rows[] = {6.0, 7.0, 5.0 + 2.0 * far, 3.0 + 2.0 * far}; // 0, 1, 2, 3 spacings away
  ASSERT_NEAR(rows[0] + 2.0 * (rows[1] + rows[2] + rows[3]), family, 1e-14);
  const std::map<int, double> across{{0, rows[1] + rows[2] + rows[3]}, {1, rows[2] + rows[3]}, {2, rows[3]}, {3, 0.0}};
  const auto expect = [&](test::Scene& scene, bool cut) {
    const couple::ParticleDamage found = couple::particle_damage(scene.rows(), *scene.d().bonds, scene.d().carried);
    ASSERT_EQ(found.damage.size(), scene.d().particles.size());
    std::vector<double> listed(found.damage.size(), 0.0);
    for (const auto& [k, damage] : couple::damaged_particles(scene.rows(), *scene.d().bonds, scene.d().carried))
      listed[static_cast<std::size_t>(k)] = damage;
    EXPECT_EQ(listed, found.damage);
    for (std::size_t k = 0; k < found.damage.size(); ++k) {
      const Vector<2> x = scene.d().particles[k].x;
      const int from = static_cast<int>(std::abs(x.y() - 0.5) / 0.05); // rows between it and the crack
      if (x.x() < 0.2 || x.x() > 0.8 || x.y() < 0.2 || x.y() > 0.8) continue;
      EXPECT_NEAR((cut ? found.precrack : found.damage)[k], (from < 4 ? across.at(from) : 0.0) / family, 1e-14);
      EXPECT_EQ((cut ? found.damage : found.precrack)[k], 0.0);
    }
  };
  test::Scene cut(test::held_particles(20)), torn(test::held_particles(20));
  cut.d().bonds->cut(crack::CrackSet({{{-9.0, 0.5}, {9.0, 0.5}}}, geom::Box<2>{{-1.0, -1.0}, {2.0, 2.0}}));
  expect(cut, true);
  Fracture fracture(*torn.d().bonds, nullptr, all_above(0.01, law::Kinematics::finite));
  fracture.apply(torn.blocks([](const Vector<2>& x) { return Vector<2>(0.0, x.y() > 0.5 ? 0.2 : 0.0); }));
  expect(torn, false);
}

TEST(Fracture, NothingBreaksInANoFailBox)
{
  test::Scene scene(plate());
  FractureRule options = all_above(0.02);
  options.no_fail = {{{0.3, 0.4}, {0.7, 0.7}}};
  Fracture fracture(*scene.d().bonds, nullptr, options);
  EXPECT_GT(fracture.apply(scene.blocks(opening)), 0);
  for (const auto& [place, damage] : damage_map(scene, 0.05)) {
    const Vector<2> x(0.05 * (static_cast<double>(place.first) + 0.5),
                      0.05 * (static_cast<double>(place.second) + 0.5));
    if (options.no_fail[0].contains(x)) {
      EXPECT_EQ(damage, 0.0);
    }
  }
}

TEST(Fracture, RefusesWhatMeansNothing)
{
  test::Scene scene(plate());
  const auto make = [&](FractureRule options) { Fracture(*scene.d().bonds, nullptr, std::move(options)); };
  EXPECT_THROW(make(all_above(0.0)), UserError);
  EXPECT_THROW(make(all_above(std::nan(""))), UserError);
  FractureRule two = all_above(0.1);
  two.critical_stretch = {0.1, 0.1};
  EXPECT_THROW(make(two), UserError);
  FractureRule none = all_above(0.1);
  none.release_share = 0.0;
  EXPECT_THROW(make(none), UserError);
}
