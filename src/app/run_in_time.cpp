#include "pdx/app/run_in_time.hpp"

#include "pdx/app/checkpoints.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/implicit_driver.hpp"
#include "pdx/solve/stable_step.hpp"

#include <fmt/format.h>
#include <optional>

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

/// A signal ended the run: no failure, and worth a line in any log.
void stop(RunFiles& files, TimeRecorder& recorder, const solve::TimeDriver& driver, const std::string& why)
{
  recorder.interrupted(driver, why);
  int rank = 0;
  MPI_Comm_rank(files.comm(), &rank);
  if (rank == 0) fmt::print("{}\n", why);
}
} // namespace

void run_in_time(RunFiles& files, mesh::Mesh& mesh, const PatchPlan& plan, std::vector<pd::Particle> particles)
{
  const SceneOptions& options = files.options;
  const bool implicit = options.time.analysis == Analysis::implicit_dynamics;
  std::optional<Checkpoints> checkpoints;
  if (!implicit) checkpoints.emplace(files);
  TimeRecorder recorder(files);
  const auto d = discretise(mesh, options, plan, std::move(particles), implicit);
  recorder.built({&mesh, &plan, d.get()});
  const StepLimits limits = limits_of(plan, d->system);
  std::unique_ptr<solve::TimeDriver> driver;
  if (implicit)
    driver = std::make_unique<solve::ImplicitDriver>(d->system);
  else
    driver = std::make_unique<solve::ExplicitDriver>(
        d->system, solve::ExplicitOptions{limits.rigorous, options.time.safety, options.time.allow_unstable});
  if (checkpoints) checkpoints->begin(files.scene, *driver, recorder);
  recorder.started(*driver, limits);
  try {
    driver->run([&] {
      recorder.after_step(*driver);
      return checkpoints ? checkpoints->after_step(*driver, recorder) : solve::TimeDriver::Verdict::go_on;
    });
  } catch (const SolverFailure&) {
    recorder.stopped_at(*driver);
    if (checkpoints) checkpoints->failed(*driver);
    throw;
  }
  if (checkpoints && !checkpoints->stopped().empty()) return stop(files, recorder, *driver, checkpoints->stopped());
  recorder.finish(*driver);
  if (checkpoints) checkpoints->finish(*driver, recorder);
}
} // namespace pdx::app
