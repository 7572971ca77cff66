#include "pdx/solve/explicit_driver.hpp"
#include "support/frequencies.hpp"
#include "support/standing_wave.hpp"

#include <chrono>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace pdx::test {
namespace {

/// n x n particles alone, held on the left: a loose body drifts, and rounding grows with the square of how far.
options::SceneOptions particles_held_left(Index n, options::KinematicsOption kinematics)
{
  options::SceneOptions options = moving(held_particles(n));
  options.conditions.resize(1);
  options.kinematics = kinematics;
  return options;
}

/// 6 x 6 elements, the middle ones with 8 x 8 particles, held on the left.
options::SceneOptions coupled_held_left(couple::Scheme scheme)
{
  options::SceneOptions options =
      with_patch(held_plate({6, 6}), {{1.0 / 3.0, 1.0 / 3.0}, {2.0 / 3.0, 2.0 / 3.0}}, 1.0 / 24.0);
  options.conditions.resize(1);
  options.scheme = scheme;
  return moving(options);
}

/// Starts with velocities without a pattern, up to `largest` [m/s]: every frequency there is.
void shake(Scene& scene, double largest)
{
  const Field speed = noise(7);
  for (const double v : scene.blocks(speed)) scene.system().initial_velocity.push_back(largest * v);
  scene.system().initial_velocity.resize(static_cast<std::size_t>(2 * scene.rows().owned()));
}

/// Energy that the scheme conserves over that at the start, less 1: the largest magnitude, the means over both halves.
struct Drift {
  double largest = 0.0, before = 0.0, after = 0.0;
};

Drift drift_of(Scene& scene, int steps, double speed)
{
  shake(scene, speed);
  const Option count("-ts_max_steps", std::to_string(steps));
  solve::ExplicitDriver driver(scene.system(), {solve::stable_step(scene.system()).limit, 0.9, false});
  const auto energy = [&] {
    const solve::KineticEnergy kinetic = driver.kinetic_energy();
    return kinetic.moving - kinetic.scheme + scene.energy(driver.local());
  };
  Drift drift;
  double first = 0.0;
  int looks = 0;
  const int interval = steps / 1000;
  const auto begin = std::chrono::steady_clock::now();
  driver.run([&] {
    if (driver.step() == 1) first = energy();
    if (driver.step() % interval) return solve::TimeDriver::Verdict::go_on;
    const double change = energy() / first - 1.0;
    drift.largest = std::max(drift.largest, std::abs(change));
    (looks++ < 500 ? drift.before : drift.after) += change / 500.0;
    return solve::TimeDriver::Verdict::go_on;
  });
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - begin;
  if (std::getenv("PDX_SHOW"))
    std::printf("%d steps, %.2f us each: largest %.2e, halves %.2e %.2e\n", steps, 1e6 * time.count() / steps,
                drift.largest, drift.before, drift.after);
  return drift;
}

int steps_to_take()
{
  const char* given = std::getenv("PDX_STEPS");
  return given ? std::atoi(given) : 100000;
}

void expect_kept(const options::SceneOptions& options, double speed = 1e-4)
{
  Scene scene(options, false, PETSC_COMM_SELF);
  const Drift drift = drift_of(scene, steps_to_take(), speed);
  EXPECT_LE(drift.largest, 1e-6);
  EXPECT_LE(std::abs(drift.after - drift.before), 1e-7);
}

TEST(FreeVibration, OfParticlesKeepsItsEnergy)
{
  expect_kept(particles_held_left(12, options::KinematicsOption::small));
}

// With finite stretches the scheme's energy is kept up to the strain there is: about speed over wave speed.
TEST(FreeVibration, OfParticlesWithFiniteStretchesKeepsItsEnergy)
{
  expect_kept(particles_held_left(12, options::KinematicsOption::finite), 2e-8);
}

TEST(FreeVibration, OfCoupledPlatesKeepsItsEnergy)
{
  for (const auto scheme : {couple::Scheme::energy, couple::Scheme::ghost}) expect_kept(coupled_held_left(scheme));
}

/// Steps until a run at `share` of the true limit is given up, 0 if it is not in 2000 steps.
int steps_until_wild(const options::SceneOptions& options, double share)
{
  Scene scene(options, false, PETSC_COMM_SELF);
  shake(scene, 1e-4);
  const double limit = true_limit(scene.system());
  const Option length("-ts_dt", fmt::format("{:.17g}", share * limit)), count("-ts_max_steps", "2000");
  solve::ExplicitDriver driver(scene.system(), {solve::stable_step(scene.system()).limit, 0.9, true});
  int last = 0;
  try {
    driver.run([&] {
      last = driver.step();
      return solve::TimeDriver::Verdict::go_on;
    });
  } catch (const SolverFailure&) {
    for (const double u : driver.u()) EXPECT_TRUE(std::isfinite(u));
    EXPECT_LE(driver.step(), last);
    return last + 1;
  }
  return 0;
}

TEST(FreeVibration, JustAboveTheTrueLimitIsCaughtSoonAndJustBelowItIsNot)
{
  for (const options::SceneOptions& options :
       {particles_held_left(12, options::KinematicsOption::small), coupled_held_left(couple::Scheme::energy)}) {
    const int steps = steps_until_wild(options, 1.02);
    EXPECT_GT(steps, 0);
    EXPECT_LE(steps, 100);
    EXPECT_EQ(steps_until_wild(options, 0.98), 0);
  }
}
} // namespace
} // namespace pdx::test
