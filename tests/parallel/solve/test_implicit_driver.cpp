#include "pdx/solve/implicit_driver.hpp"
#include "support/oscillators.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace pdx::test::implicit_driver {
namespace {
using field::Drive;
const auto go_on = [] { return solve::TimeDriver::Verdict::go_on; };

TEST(ImplicitDriver, IsOfSecondOrderAndStableBeyondTheExplicitLimit)
{
  double before = 0.0;
  for (const double dt : {0.1, 0.05, 0.025}) {
    Oscillators o(Oscillators::Given{{"-ts_dt", std::to_string(dt)}, {"-ts_max_time", "4"}});
    o.system().initial_velocity = {3.0, 0.0};
    solve::ImplicitDriver driver(o.system());
    driver.run(go_on);
    const double error = std::abs(driver.u()[0] - 2.0 * std::sin(6.0));
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.4);
    }
    before = error;
  }
  Oscillators o(Oscillators::Given{{"-ts_dt", std::to_string(5.0 * Oscillators::kLimit)}, {"-ts_max_steps", "100"}});
  o.system().initial_velocity = {3.0, 0.0};
  solve::ImplicitDriver driver(o.system());
  EXPECT_NO_THROW(driver.run(go_on));
}

TEST(ImplicitDriver, KeepsTheEnergyOfALinearSystemAndAssemblesItOnce)
{
  Oscillators o(Oscillators::Given{{"-ts_dt", "0.4"}, {"-ts_max_steps", "60"}});
  o.system().initial_velocity = {1.0, 2.0};
  solve::ImplicitDriver driver(o.system());
  double second = 0.0; // the method starts with a step of its own
  driver.run([&] {
    const double energy = driver.kinetic_energy().moving + o.stored(driver);
    if (driver.step() == 1) second = energy;
    EXPECT_NEAR(energy, second, 1e-7 * second);
    return solve::TimeDriver::Verdict::go_on;
  });
  EXPECT_LE(driver.assemblies(), 3); // the start has a step length of its own
}

TEST(ImplicitDriver, MovesWhatIsHeld)
{
  Oscillators o(Oscillators::Given{{"-ts_dt", "0.1"}, {"-ts_max_time", "2"}});
  o.system().prescribed.components = {0};
  o.system().prescribed.values = {6.0};
  o.system().drives.push_back({Drive::Kind::displacement, field::History::ramp(0.0, 2.0), {0}, {6.0}});
  o.system().bind();
  solve::ImplicitDriver driver(o.system());
  driver.run(go_on);
  EXPECT_NEAR(driver.u()[0], 6.0, 1e-12);
  const double initial = driver.clock().initial;
  EXPECT_NEAR(driver.kinetic_energy().moving + o.stored(driver), o.work(driver) + initial, 1e-9);
}

TEST(ImplicitDriver, WantsAStep)
{
  Oscillators o(Oscillators::Given{{"-ts_max_time", "2"}});
  EXPECT_THROW(solve::ImplicitDriver(o.system()), UserError);
}
} // namespace
} // namespace pdx::test::implicit_driver
