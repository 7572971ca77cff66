#include "pdx/app/run_in_time.hpp"

#include "pdx/app/checkpoints.hpp"
#include "pdx/app/particle_warnings.hpp"
#include "pdx/app/solid.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/implicit_driver.hpp"
#include "pdx/solve/stable_step.hpp"

#include <fmt/format.h>
#include <optional>

namespace pdx::app {
namespace {
template <int Dim> StepLimits limits_of(std::span<const pd::Stencil<Dim>> stencils, const field::System& system)
{
  StepLimits limits{solve::stable_step(system).limit, 0.0};
  for (const auto& stencil : stencils) {
    const double papers = pd::papers_step(stencil);
    limits.papers = limits.papers > 0.0 ? std::min(limits.papers, papers) : papers;
  }
  return limits;
}

/// What steps a scene through time and records it, with checkpoints where steps are explicit.
class TimeRun {
public:
  explicit TimeRun(RunFiles& files)
      : files_(files), implicit_(files.options.time.analysis == Analysis::implicit_dynamics), recorder_(files)
  {
    if (!implicit_) checkpoints_.emplace(files);
  }

  bool implicit() const { return implicit_; }
  void built(const Standing& scene) { recorder_.built(scene); }

  void run(field::System& system, const StepLimits& limits)
  {
    const TimeOptions& time = files_.options.time;
    std::unique_ptr<solve::TimeDriver> driver;
    if (implicit_)
      driver = std::make_unique<solve::ImplicitDriver>(system);
    else
      driver = std::make_unique<solve::ExplicitDriver>(
          system, solve::ExplicitOptions{limits.rigorous, time.safety, time.allow_unstable});
    files_.velocity = driver->v();
    if (checkpoints_) checkpoints_->begin(files_.scene, *driver, recorder_);
    recorder_.started(*driver, limits);
    try {
      StopLook look(files_.comm());
      driver->run([&] {
        recorder_.after_step(*driver);
        if (checkpoints_) return checkpoints_->after_step(*driver, recorder_);
        look();
        return solve::TimeDriver::Verdict::go_on;
      });
    } catch (const Stopped& stop) {
      recorder_.stopped_at(*driver);
      throw Stopped(fmt::format("{} at step {}, time {:.6g} s: implicit steps have no checkpoint", stop.what(),
                                driver->step(), driver->time()));
    } catch (const SolverFailure&) {
      files_.after_failure([&] { recorder_.stopped_at(*driver); });
      if (checkpoints_) files_.after_failure([&] { checkpoints_->failed(*driver); });
      throw;
    }
    if (checkpoints_ && !checkpoints_->stopped().empty()) return stop(*driver);
    recorder_.finish(*driver);
    if (checkpoints_) checkpoints_->finish(*driver, recorder_);
  }

private:
  /// A signal ended the run, and a checkpoint was written.
  void stop(const solve::TimeDriver& driver)
  {
    recorder_.interrupted(driver);
    files_.stop(checkpoints_->stopped());
  }

  RunFiles& files_;
  bool implicit_;
  TimeRecorder recorder_;
  std::optional<Checkpoints> checkpoints_;
};
} // namespace

void run_in_time(RunFiles& files, mesh::Mesh& mesh, const PatchPlan& plan, std::vector<pd::Particle> particles)
{
  TimeRun run(files);
  const auto d = discretise(mesh, files.options, plan, std::move(particles), run.implicit());
  stop_if_told(files.comm());
  run.built({&mesh, &plan, d.get()});
  run.run(d->system, limits_of<2>(plan.stencils, d->system));
}

void run_solid(RunFiles& files)
{
  TimeRun run(files);
  mesh::MeshOptions mesh_options = files.options.mesh;
  const SolidPlan plan = plan_solid(files.options, mesh_options);
  require_rows(files.options, plan.lattice.count);
  files.warn(thin_warning(files.options, plan.lattice.count));
  mesh::Mesh mesh = mesh::build(files.comm(), mesh_options, cell_cost(plan));
  stop_if_told(files.comm());
  pd::Particles swarm(files.comm());
  const auto solid = discretise(files.comm(), files.options, plan, make_particles(mesh, plan, swarm));
  stop_if_told(files.comm());
  run.built({&mesh, solid.get()});
  run.run(solid->system, limits_of<3>({&plan.stencil, 1}, solid->system));
}

namespace {
template <int Dim> void run_cloud_in(RunFiles& files, SceneOptions& options)
{
  TimeRun run(files);
  auto plan = std::make_unique<CloudPlan<Dim>>(plan_cloud<Dim>(options));
  mesh::Mesh mesh = mesh::build(files.comm(), plan->mesh, cell_cost(*plan));
  stop_if_told(files.comm());
  pd::Particles swarm(files.comm());
  const auto body = discretise(files.comm(), files.options, *plan, make_particles(mesh, *plan, swarm));
  plan.reset(); // the whole cloud
  stop_if_told(files.comm());
  for (const std::string& line : cloud_warnings(options, *body)) files.warn(line);
  run.built({&mesh, body.get()});
  run.run(body->system, limits_of<Dim>({}, body->system));
}
} // namespace

void run_cloud(RunFiles& files, SceneOptions& options)
{
  if (options.solid) return run_cloud_in<3>(files, options);
  run_cloud_in<2>(files, options);
}
} // namespace pdx::app
