#include "pdx/app/run_in_time.hpp"

#include "pdx/app/time_recorder.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/stable_step.hpp"

namespace pdx::app {
namespace {
StepLimits limits_of(const PatchPlan& plan, const field::System& system)
{
  StepLimits limits{solve::stable_step(system).limit, 0.0};
  for (const auto& stencil : plan.stencils) {
    const double papers = pd::papers_step(stencil);
    limits.papers = limits.papers > 0.0 ? std::min(limits.papers, papers) : papers;
  }
  return limits;
}
} // namespace

void run_explicit(RunFiles& files, mesh::Mesh& mesh, const PatchPlan& plan, std::vector<pd::Particle> particles)
{
  const SceneOptions& options = files.options;
  TimeRecorder recorder(files);
  const auto d = discretise(mesh, options, plan, std::move(particles), false);
  recorder.built({&mesh, &plan, d.get()});
  const StepLimits limits = limits_of(plan, d->system);
  solve::ExplicitDriver driver(d->system, {limits.rigorous, options.time.safety, options.time.allow_unstable});
  recorder.started(driver, limits);
  try {
    driver.run([&] {
      recorder.after_step(driver);
      return solve::ExplicitDriver::Verdict::go_on;
    });
  } catch (const SolverFailure&) {
    recorder.stopped_at(driver);
    throw;
  }
  recorder.finish(driver);
}
} // namespace pdx::app
