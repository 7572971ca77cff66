#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/implicit_driver.hpp"
#include "pdx/solve/stable_step.hpp"
#include "support/standing_wave.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace pdx::test {
namespace {
using options::Analysis;
constexpr double kShare = 0.3; // of a period, the length of all runs
const auto go_on = [] { return solve::TimeDriver::Verdict::go_on; };

std::string text(double value) { return fmt::format("{:.17g}", value); }

/// The displacement of the owned rows after `steps` equal steps.
std::vector<double> stepped(Scene& scene, int steps)
{
  const StandingWave wave(scene.options().elastic);
  const double end = kShare * wave.period();
  const Option length("-ts_dt", text(end / steps)), until("-ts_max_steps", std::to_string(steps));
  std::unique_ptr<solve::TimeDriver> driver;
  if (scene.options().time.analysis == Analysis::implicit_dynamics)
    driver = std::make_unique<solve::ImplicitDriver>(scene.system());
  else
    driver = std::make_unique<solve::ExplicitDriver>(
        scene.system(), solve::ExplicitOptions{solve::stable_step(scene.system()).limit, 0.9, false});
  driver->run(go_on);
  EXPECT_NEAR(driver->time(), end, 1e-12 * end);
  return {driver->u().begin(), driver->u().end()};
}

/// Fewest steps that are stable with room to spare.
int enough_steps(Scene& scene)
{
  const StandingWave wave(scene.options().elastic);
  return static_cast<int>(std::ceil(kShare * wave.period() / (0.8 * solve::stable_step(scene.system()).limit)));
}

double distance(const Scene& scene, const std::vector<double>& a, const std::vector<double>& b)
{
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(scene.sum(sum));
}

/// Error in L2 of the wave, its steps so short that only the error in space is left.
double error_of(const options::SceneOptions& options)
{
  Scene scene(moving(options));
  const StandingWave wave(scene.options().elastic);
  wave.drive(scene);
  const std::vector<double> u = stepped(scene, 8 * enough_steps(scene));
  const VecHandle vector = scene.rows().vector();
  double* values = nullptr;
  PDX_CALL(VecGetArray(vector.get(), &values));
  std::ranges::copy(u, values);
  PDX_CALL(VecRestoreArray(vector.get(), &values));
  return scene.l2_error(vector.get(), wave.at(kShare * wave.period()));
}

void expect_order(const std::vector<double>& errors, double least, double most)
{
  EXPECT_GT(errors.front(), 1e-4); // no error at all would mean that nothing was measured
  for (std::size_t k = 1; k < errors.size(); ++k) {
    const double order = std::log2(errors[k - 1] / errors[k]);
    if (std::getenv("PDX_SHOW")) std::printf("error %.3e order %.3f\n", errors[k], order);
    EXPECT_GE(order, least) << "halving " << k;
    EXPECT_LE(order, most) << "halving " << k;
  }
}

options::SceneOptions coupled(Index n) { return with_patch(held_plate({n, n}), {{0.25, 0.25}, {0.75, 0.75}}, 0.5 / n); }

TEST(WaveOrder, OfElementsInSpaceIsTwo)
{
  std::vector<double> errors;
  for (const Index n : {8, 16, 32}) errors.push_back(error_of(held_plate({n, n})));
  expect_order(errors, 1.95, 2.1);
}

// Horizon and spacing shrink together.
TEST(WaveOrder, OfParticlesInSpaceIsTwo)
{
  std::vector<double> errors;
  for (const Index n : {10, 20, 40}) {
    auto options = held_particles(n);
    options.pd.surface_correction = options::SurfaceCorrection::none; // the layers go on beyond what is modelled
    errors.push_back(error_of(options));
  }
  expect_order(errors, 1.95, 2.4);
}

TEST(WaveOrder, OfCoupledPlatesInSpaceIsTwo)
{
  std::vector<double> errors;
  for (const Index n : {8, 16, 32}) errors.push_back(error_of(coupled(n)));
  expect_order(errors, 1.9, 2.4);
}

TEST(WaveOrder, InTimeIsTwo)
{
  auto particles = held_particles(12);
  particles.pd.surface_correction = options::SurfaceCorrection::none;
  for (const options::SceneOptions& options : {held_plate({12, 12}), particles, coupled(8)}) {
    Scene scene(moving(options));
    StandingWave(scene.options().elastic).drive(scene);
    const int steps = enough_steps(scene);
    const std::vector<double> exact = stepped(scene, 64 * steps);
    std::vector<double> errors;
    for (const int n : {1, 2, 4}) errors.push_back(distance(scene, stepped(scene, n * steps), exact));
    expect_order(errors, 1.95, 2.1);
  }
}

// Trapezoidal steps of several explicit limits follow the explicit run, with an error of their own that is quartered.
TEST(WaveOrder, OfImplicitStepsIsTwoAndTheirLimitTheExplicitRun)
{
  Scene explicitly(moving(coupled(32))), implicitly(moving(coupled(32), Analysis::implicit_dynamics), true);
  const StandingWave wave(explicitly.options().elastic);
  wave.drive(explicitly);
  wave.drive(implicitly);
  const int longest = (enough_steps(explicitly) + 7) / 8; // steps of 6 limits
  const std::vector<double> exact = stepped(explicitly, 64 * longest);
  std::vector<double> errors;
  for (const int n : {1, 2, 4}) errors.push_back(distance(explicitly, stepped(implicitly, n * longest), exact));
  expect_order(errors, 1.8, 2.2);
}
} // namespace
} // namespace pdx::test
