#include "pdx/solve/explicit_driver.hpp"
#include "support/oscillators.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace {
using namespace pdx;
using field::Drive;

using test::Oscillators;
const solve::ExplicitOptions kOptions{Oscillators::kLimit, 0.9, false};
const auto go_on = [] { return solve::ExplicitDriver::Verdict::go_on; };

void hold(field::System& system, Drive::Kind kind, const field::History& history, double value)
{
  system.prescribed.components = {0};
  system.prescribed.values = {value};
  system.drives.push_back({kind, history, {0}, {value}});
  system.bind();
}

TEST(ExplicitDriver, IsOfSecondOrderInTime)
{
  double before = 0.0;
  for (const double dt : {0.1, 0.05, 0.025}) {
    Oscillators o(Oscillators::Given{{"-ts_dt", std::to_string(dt)}, {"-ts_max_time", "4"}});
    o.system().initial_velocity = {3.0, -1.5};
    solve::ExplicitDriver driver(o.system(), kOptions);
    driver.run(go_on);
    const double error = std::abs(driver.u()[0] - 2.0 * std::sin(6.0));
    EXPECT_NEAR(driver.u()[1], -0.5 * driver.u()[0], 1e-12);
    if (before > 0.0) {
      EXPECT_NEAR(before / error, 4.0, 0.1);
    }
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

TEST(ExplicitDriver, EndsExactlyAndAtTheLastStep)
{
  Oscillators o(Oscillators::Given{{"-ts_max_time", "7.3"}});
  o.system().initial_velocity = {1.0, 0.0};
  solve::ExplicitDriver driver(o.system(), kOptions);
  EXPECT_EQ(driver.expected_steps(), 7); // of at most 0.9 * 4/3
  int calls = 0;
  driver.run([&] {
    ++calls;
    return solve::ExplicitDriver::Verdict::go_on;
  });
  EXPECT_EQ(calls, 7);
  EXPECT_EQ(driver.step(), 7);
  EXPECT_NEAR(driver.time(), 7.3, 1e-14);
}

TEST(ExplicitDriver, TakesNoStepForARounding)
{
  for (int k = 1; k <= 40; ++k) {
    const std::string end = std::to_string(0.1 * k);
    Oscillators o(Oscillators::Given{{"-ts_dt", "0.1"}, {"-ts_max_time", end}});
    o.system().initial_velocity = {1.0, 0.0};
    solve::ExplicitDriver driver(o.system(), kOptions);
    driver.run(go_on);
    EXPECT_EQ(driver.step(), k) << end;
    EXPECT_EQ(driver.time(), std::stod(end));
  }
}

TEST(ExplicitDriver, KeepsTheEnergyItsSchemeConserves)
{
  Oscillators o(Oscillators::Given{{"-ts_dt", "0.5"}, {"-ts_max_steps", "200"}});
  o.system().initial_velocity = {1.0, 2.0};
  solve::ExplicitDriver driver(o.system(), kOptions);
  const double start = test::ranks() * 0.5 * 4.0 * 5.0;
  double oscillation = 0.0;
  driver.run([&] {
    const solve::KineticEnergy kinetic = driver.kinetic_energy();
    EXPECT_NEAR(kinetic.moving + o.stored(driver) - kinetic.scheme, start, 1e-12 * start);
    oscillation = std::max(oscillation, kinetic.scheme);
    return solve::ExplicitDriver::Verdict::go_on;
  });
  EXPECT_GT(oscillation, 0.1 * start); // it is no small thing at this step
}

TEST(ExplicitDriver, BooksTheWorkOfLoads)
{
  Oscillators o(Oscillators::Given{{"-ts_dt", "0.2"}, {"-ts_max_time", "9"}});
  o.system().drives.push_back({Drive::Kind::force, field::History::gaussian(3.0, 0.8), {0, 1}, {5.0, -2.0}});
  solve::ExplicitDriver driver(o.system(), kOptions);
  driver.run(go_on);
  const solve::KineticEnergy kinetic = driver.kinetic_energy();
  const double total = kinetic.moving + o.stored(driver);
  EXPECT_GT(total, 0.1);
  EXPECT_NEAR(total - kinetic.scheme, o.work(driver), 1e-12 * total);
}

TEST(ExplicitDriver, BooksASuddenLoadToRoundingAndNoneOfWhatItsHolderCarries)
{
  Oscillators o(Oscillators::Given{{"-ts_dt", "0.5"}, {"-ts_max_time", "9"}});
  hold(o.system(), Drive::Kind::displacement, field::History(), 0.0);
  o.system().drives.push_back({Drive::Kind::force, field::History(), {0, 1}, {50.0, -2.0}});
  solve::ExplicitDriver driver(o.system(), kOptions);
  driver.run(go_on);
  const solve::KineticEnergy kinetic = driver.kinetic_energy();
  const double total = kinetic.moving + o.stored(driver);
  EXPECT_NEAR(total - kinetic.scheme, o.work(driver) + driver.clock().initial, 1e-12 * total);
}

TEST(ExplicitDriver, BooksTheWorkOfPrescribedMotion)
{
  for (const Drive::Kind kind : {Drive::Kind::displacement, Drive::Kind::velocity}) {
    Oscillators o(Oscillators::Given{{"-ts_dt", "0.1"}, {"-ts_max_time", "2"}});
    hold(o.system(), kind, field::History::ramp(0.0, 2.0), 6.0);
    solve::ExplicitDriver driver(o.system(), kOptions);
    driver.run(go_on);
    EXPECT_NEAR(driver.u()[0], 6.0, 1e-12); // at the end of the ramp, or 6 t^2 / 4
    const double speed = driver.v()[0];
    EXPECT_NEAR(speed, kind == Drive::Kind::velocity ? 6.0 : 0.0, 1e-9);
    const double initial = driver.clock().initial;
    EXPECT_NEAR(driver.kinetic_energy().moving + o.stored(driver), o.work(driver) + initial, 1e-9);
  }
}

TEST(ExplicitDriver, RefusesWhatCannotBe)
{
  {
    Oscillators o(Oscillators::Given{{"-ts_dt", "1.34"}, {"-ts_max_time", "2"}});
    EXPECT_THROW(solve::ExplicitDriver(o.system(), kOptions), UserError);
    EXPECT_NO_THROW(solve::ExplicitDriver(o.system(), {Oscillators::kLimit, 0.9, true}));
  }
  Oscillators endless(Oscillators::Given{});
  EXPECT_THROW(solve::ExplicitDriver(endless.system(), kOptions), UserError);
  Oscillators other(Oscillators::Given{{"-ts_max_time", "2"}, {"-ts_type", "rk"}});
  EXPECT_THROW(solve::ExplicitDriver(other.system(), kOptions), UserError);
}

TEST(ExplicitDriver, CatchesARunGoneWildAndKeepsTheLastSoundState)
{
  Oscillators o(Oscillators::Given{{"-ts_dt", std::to_string(1.02 * Oscillators::kLimit)}, {"-ts_max_steps", "1000"}});
  o.system().initial_velocity = {1.0, 0.0};
  solve::ExplicitDriver driver(o.system(), {Oscillators::kLimit, 0.9, true});
  EXPECT_THROW(driver.run(go_on), SolverFailure);
  EXPECT_LT(driver.step(), 100);
  for (const double v : driver.v()) EXPECT_TRUE(std::isfinite(v));
}

TEST(ExplicitDriver, GoesOnToTheLastBit)
{
  const std::vector<std::pair<const char*, std::string>> options{{"-ts_dt", "0.13"}, {"-ts_max_time", "9"}};
  const field::History pulse = field::History::gaussian(4.0, 1.0);
  std::vector<double> end;
  field::State state;
  solve::ExplicitDriver::Clock clock;
  double work = 0.0;
  {
    Oscillators o(options, 3);
    o.system().drives.push_back({Drive::Kind::force, pulse, {2, 5}, {1.0, 0.7}});
    solve::ExplicitDriver driver(o.system(), kOptions);
    driver.run([&] {
      if (driver.step() == 31) {
        state = driver.state();
        clock = driver.clock();
      }
      return solve::ExplicitDriver::Verdict::go_on;
    });
    end.assign(driver.u().begin(), driver.u().end());
    work = driver.moving().work();
  }
  Oscillators o(options, 3);
  o.system().drives.push_back({Drive::Kind::force, pulse, {2, 5}, {1.0, 0.7}});
  solve::ExplicitDriver driver(o.system(), kOptions);
  driver.resume(clock, state);
  driver.run(go_on);
  EXPECT_EQ(driver.step(), 70);
  EXPECT_EQ(std::vector<double>(driver.u().begin(), driver.u().end()), end);
  EXPECT_EQ(driver.moving().work(), work);
}

TEST(ExplicitDriver, StopsWhenTold)
{
  Oscillators o(Oscillators::Given{{"-ts_dt", "0.1"}, {"-ts_max_time", "9"}});
  o.system().initial_velocity = {1.0, 0.0};
  solve::ExplicitDriver driver(o.system(), kOptions);
  driver.run([&] {
    return driver.step() == 12 ? solve::ExplicitDriver::Verdict::stop : solve::ExplicitDriver::Verdict::go_on;
  });
  EXPECT_EQ(driver.step(), 12);
}

TEST(ExplicitDriver, MovesTheHalvesOfATiedNodeByTheirOwnMasses)
{
  // Node row 0 and its set row 1: u and w = u - 2 a, masses 4 each; a force on u alone must leave w at rest.
  Oscillators o(Oscillators::Given{{"-ts_dt", "0.01"}, {"-ts_max_time", "0.1"}}, 2);
  for (test::Spring& spring : o.bed->springs) spring.broken = true;
  class TiedRows final : public test::InertTerm {
  public:
    void ties(std::vector<field::Tie>& list) const override { list.push_back({0, 1, -2.0}); }
  };
  o.system().terms.push_back(std::make_unique<TiedRows>());
  // f_u = 8 and f_w = 0 is f on (u, a) = (8 + 0, 0); f_u = 0 and f_w = 8 is (8, -16)
  o.system().drives.push_back({Drive::Kind::force, field::History(), {0, 1, 3}, {8.0, 8.0, -16.0}});
  solve::ExplicitDriver driver(o.system(), kOptions);
  driver.run(go_on);
  const double moved = 0.5 * 2.0 * 0.01; // 1/2 f/m t^2
  EXPECT_NEAR(driver.u()[0], moved, 1e-12);
  EXPECT_NEAR(driver.u()[0] - 2.0 * driver.u()[2], 0.0, 1e-12);
  EXPECT_NEAR(driver.u()[1], 0.0, 1e-12);
  EXPECT_NEAR(driver.u()[1] - 2.0 * driver.u()[3], moved, 1e-12);
  EXPECT_NEAR(driver.kinetic_energy().moving, o.work(driver), 1e-12);
}
} // namespace
