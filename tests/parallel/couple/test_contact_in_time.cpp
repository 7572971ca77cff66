#include "pdx/base/gather.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/stable_step.hpp"
#include "support/ranks.hpp"
#include "support/touching.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using test::Touching;
using Verdict = solve::TimeDriver::Verdict;

namespace test_contact_in_time {
/// A value of -ts_max_time or -ts_max_steps while it lives.
struct Until {
  explicit Until(const char* name, double value) : name_(name)
  {
    PDX_CALL(PetscOptionsSetValue(nullptr, name, std::to_string(value).c_str()));
  }
  ~Until() { PDX_CALL(PetscOptionsClearValue(nullptr, name_)); }

private:
  const char* name_;
};

template <int Dim> solve::ExplicitDriver driver_of(Touching<Dim>& scene)
{
  return {scene.system, {solve::stable_step(scene.system).limit, 0.9, false}};
}

double total_energy(const solve::TimeDriver& driver)
{
  const solve::KineticEnergy kinetic = driver.kinetic_energy();
  return kinetic.moving - kinetic.scheme + driver.moving().stored_energy();
}

/// A block that flies at another one, which turns at rest.
template <int Dim> std::vector<test::TouchingBody<Dim>> thrown()
{
  Site<Dim> count;
  count.fill(4);
  count[0] = 6;
  Vector<Dim> corner = Vector<Dim>::Constant(0.9), velocity = Vector<Dim>::Zero();
  corner[0] = 7.6;
  velocity[0] = 0.04;
  return {{"striker", Vector<Dim>::Zero(), count, 1.0, 1.0, 1.0, true, false, velocity},
          {"target", corner, count, 1.0, 2.0, 1.0, false, false, Vector<Dim>::Zero(), 0.2}};
}

struct Crash {
  std::vector<double> u; // of all rows
  std::array<double, 3> momentum{}, impulse{};
  double drift = 0.0, most_contact = 0.0;
};

template <int Dim> Crash crash(MPI_Comm comm, double friction)
{
  const Until end("-ts_max_time", 100.0);
  couple::ContactOptions options;
  options.friction = friction;
  Touching<Dim> scene(comm, thrown<Dim>(), options);
  solve::ExplicitDriver driver = driver_of(scene);
  const std::array<double, 3> before = driver.moving().momentum(driver.v());
  Crash result;
  driver.run([&] {
    result.most_contact = std::max(result.most_contact, scene.sum(scene.contact->energy(driver.local())));
    result.drift = std::max(result.drift, std::abs(total_energy(driver) / driver.clock().initial - 1.0));
    return Verdict::go_on;
  });
  result.momentum = driver.moving().momentum(driver.v());
  double mass = 0.0;
  for (const auto& row : scene.rows) mass += row.body == 1 ? row.mass : 0.0;
  for (int d = 0; d < Dim; ++d) {
    const auto k = static_cast<std::size_t>(d);
    result.momentum[k] = (result.momentum[k] - before[k]) / before[0];
    result.impulse[k] = (scene.sum(-scene.books->impulse(0)[k]) - mass * scene.mean(driver.v(), 1)[d]) / before[0];
  }
  result.u = scene.of_all(driver.u());
  return result;
}

template <class T> class ContactInTime : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ContactInTime, Dimensions);

TYPED_TEST(ContactInTime, BlocksThatCollideKeepMomentumAndEnergyOnAnyNumberOfRanks)
{
  for (const double friction : {0.0, 0.3}) {
    const Crash together = crash<TypeParam::value>(PETSC_COMM_WORLD, friction);
    EXPECT_GT(together.most_contact, 1e-4);
    EXPECT_LT(together.drift, 5e-3); // of second order in the step
    for (std::size_t d = 0; d < 3; ++d) {
      EXPECT_NEAR(together.momentum[d], 0.0, 1e-13);
      EXPECT_NEAR(together.impulse[d], 0.0, 1e-13);
    }
    const Crash alone = crash<TypeParam::value>(PETSC_COMM_SELF, friction);
    for (std::size_t k = 0; k < alone.u.size(); ++k) EXPECT_NEAR(together.u[k], alone.u[k], 1e-10);
  }
}

/// Two scenes of one kind, of which the second goes on from where the first has stopped.
template <int Dim> std::pair<std::vector<double>, std::vector<double>> run(bool stop)
{
  const Until end("-ts_max_time", 100.0);
  couple::ContactOptions options;
  options.friction = 0.1;
  Touching<Dim> first(PETSC_COMM_WORLD, thrown<Dim>(), options), second(PETSC_COMM_WORLD, thrown<Dim>(), options);
  solve::ExplicitDriver driver = driver_of(first);
  int touched = 0; // steps at the end of which something touches
  driver.run([&] {
    touched += first.sum(static_cast<double>(first.contact->grips().size())) > 0.0;
    return stop && touched == 8 ? Verdict::stop : Verdict::go_on;
  });
  EXPECT_GE(touched, 8);
  if (!stop) return {first.of_all(driver.u()), first.books->sums()};
  second.contact->set_grips(gather_all(PETSC_COMM_WORLD, first.contact->grips()));
  second.books->resume(first.books->sums());
  solve::ExplicitDriver next = driver_of(second);
  next.resume(driver.clock(), driver.state());
  next.run([] { return Verdict::go_on; });
  return {second.of_all(next.u()), second.books->sums()};
}

TYPED_TEST(ContactInTime, GoesOnToTheLastBit) { EXPECT_EQ(run<TypeParam::value>(true), run<TypeParam::value>(false)); }

/// A block on a slope of lattice points, both turned by `slope`, for a while.
struct Slide {
  double way = 0.0, lost = 0.0, drift = 0.0; ///< along the slope [m]; by friction, and nowhere [J]
  double fall = 0.0, energy = 0.0;           ///< of free fall: its way, the energy of its speed [m, J]
};

Slide slide(double slope, double friction)
{
  constexpr double kGravity = 1e-3, kRise = 60.0;
  const Until end("-ts_max_time", 150.0);
  const Vector<2> along(std::cos(slope), std::sin(slope)), up(-along.y(), along.x());
  couple::ContactOptions options;
  options.friction = friction;
  Touching<2> scene(
      PETSC_COMM_WORLD,
      {{"slope", {0.0, 0.0}, {44, 2}, 1.0, 1.0, 1.0, false, true, {0.0, 0.0}, slope},
       {"block", Vector<2>(30.3 * along + 2.0 * up), {8, 4}, 1.0, 1.0, 1.0, false, false, {0.0, 0.0}, slope}},
      options);
  scene.weigh_down({0.0, -kGravity}, kRise);
  solve::ExplicitDriver driver = driver_of(scene);
  Slide result;
  driver.run([&] {
    result.drift = std::max(result.drift, std::abs(total_energy(driver) - scene.sum(driver.moving().work())));
    return Verdict::go_on;
  });
  result.way = -scene.mean(driver.u(), 1).dot(along);
  result.lost = scene.sum(scene.books->dissipated());
  const double held = driver.time() - kRise; // falls by g t^3 / 6 t_r, then from there with g t_r / 2
  result.fall = kGravity * (kRise * kRise / 6.0 + 0.5 * kRise * held + 0.5 * held * held);
  const double speed = kGravity * (0.5 * kRise + held);
  result.energy = 0.5 * 32.0 * speed * speed;
  return result;
}

TEST(ContactSlide, ABlockSlidesStraightDownALatticeOfPointsWithoutFriction)
{
  const double slope = 0.25;
  const Slide s = slide(slope, 0.0);
  const double expected = std::sin(slope) * s.fall;
  EXPECT_NEAR(s.way, expected, 1e-3 * expected);
  EXPECT_EQ(s.lost, 0.0);
}

TEST(ContactSlide, WithFrictionAsCoulombSays)
{
  const double slope = 0.4, friction = 0.2;
  const Slide s = slide(slope, friction);
  const double expected = (std::sin(slope) - friction * std::cos(slope)) * s.fall;
  EXPECT_NEAR(s.way, expected, 0.01 * expected);
  const double lost = friction * std::cos(slope) * (std::sin(slope) - friction * std::cos(slope)) * s.energy;
  EXPECT_NEAR(s.lost, lost, 0.03 * lost);
  EXPECT_LT(s.drift, 0.01 * s.lost);
}

TEST(ContactSlide, OrSticks)
{
  const Slide s = slide(0.4, 0.6);
  EXPECT_LT(std::abs(s.way), 0.1);
}
} // namespace test_contact_in_time
