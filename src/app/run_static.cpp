#include "pdx/app/run_static.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/change/patch_mover.hpp"
#include "pdx/change/static_checkpoints.hpp"
#include "pdx/change/static_scene.hpp"
#include "pdx/record/crack_results.hpp"
#include "pdx/record/dry_run.hpp"
#include "pdx/record/prior.hpp"
#include "pdx/record/recorder.hpp"
#include "pdx/scene/particle_warnings.hpp"
#include "pdx/scene/scene_names.hpp"
#include "pdx/scene/static_solving.hpp"
#include "pdx/solve/static_solver.hpp"

#include <fmt/format.h>
#include <utility>

namespace pdx::app {
namespace {
using solve::Verdict;

/// A scene under growing loads and what records it. The scene and its driver live for one layout; files, recorder and
/// the path of loads outlive them.
class StaticRun {
public:
  StaticRun(record::RunFiles& files, std::shared_ptr<const scene::PointPlan<2>> points)
      : files_(files), scene_(files.comm(), files.options, scene::wants_assembled(files.options), std::move(points)),
        recorder_(files), mover_(files.options), checkpoints_(files, mover_)
  {
    if (checkpoints_.goes_on()) scene_.begin_with(checkpoints_.layout(), checkpoints_.dormant());
  }

  void run()
  {
    lay();
    scene_.build();
    const std::vector<double> at_rest(2 * static_cast<std::size_t>(d().system.halo->size()), 0.0);
    record::require_contours({scene_.ground().mesh, files_.options, scene_.plan(), d(), at_rest});
    stop_if_told(files_.comm());
    for (const std::string& warning : scene_.ground().warnings()) files_.warn(warning);
    files_.warn(scene::region_warning(scene_.ground().options, scene_.ground().mesh, scene_.ground().particles));
    if (mover_.follows()) files_.warn(mover_.begin(scene_.view(), scene_.plan()));
    recorder_.built(scene_.ground().mesh, d());
    solve::LoadPath path(files_.options.load.steps, files_.options.load.halvings);
    if (checkpoints_.goes_on())
      resume(path);
    else
      drive({});
    files_.started();
    files_.begin_probes(driver_->report().steps, load_, u());
    if (files_.options.output.dry_run) return try_solve(path);
    if (path.done())
      recorder_.stopped_at(u()); // there is nothing left to do
    else if (checkpoints_.goes_on() && change_due(driver_->report().steps, path))
      change(); // a checkpoint is written before
    while (load(path) == Verdict::relayout) change();
    recorder_.finish(driver_->report());
  }

private:
  /// The first load, of which nothing breaks and nothing is kept.
  void try_solve(solve::LoadPath& path)
  {
    record::DryRun dry(files_);
    dry.fields(0.0, u());
    const auto breaking = std::exchange(d().system.after, {});
    const double begin = MPI_Wtime();
    (void)driver_->run(u(), path, [](const solve::Step&, Vec) { return Verdict::stop; });
    dry.solve(MPI_Wtime() - begin);
    dry.tell_loads(files_.options.load.steps, driver_->report().linear_iterations);
  }

  /// The ground of the first scene, and what is solved on it before.
  void lay()
  {
    const options::SceneOptions& options = files_.options;
    scene_.lay();
    scene::Ground& ground = scene_.ground();
    if (options.post.reference_fe) {
      scene::cover_cells(ground.mesh, ground.plan, ground.mesh_options,
                         options.frame); // refuses wrong patches first
      ground.mesh.uncover();
      const double begin = MPI_Wtime();
      prior_.reference = record::reference_displacement(ground.mesh, options);
      files_.solved_before += MPI_Wtime() - begin;
    }
    ground.lay_particles();
    if (!options.post.energy_release) return;
    const PauseCounts pause;
    const double begin = MPI_Wtime();
    prior_.energy_release =
        record::energy_release(ground.mesh, options, ground.plan, ground.particles, scene_.assembled());
    files_.solved_before += MPI_Wtime() - begin;
    scene::cover_cells(ground.mesh, ground.plan, options.mesh);
  }

  /// From a checkpoint: the scene stands as it was laid there.
  void resume(solve::LoadPath& path)
  {
    change::StaticCheckpoints::Start start = checkpoints_.start(scene_.standing(), path);
    load_ = start.load;
    d().system.go_to(load_);
    field::set_owned_values(u(), start.u);
    const std::vector<double> force = scene_.internal_force(start.u);
    recorder_.take_notes(start.notes, load_, std::move(start.u), force);
    drive(std::move(start.report));
  }

  void change()
  {
    files_.told_if_refused([&] { renew(); });
  }

  /// Do patches hand back what lies behind an accepted load, or is all to be made anew?
  bool change_due(int step, const solve::LoadPath& path)
  {
    if (path.done()) return false;
    if (mover_.may_contract()) {
      change_ = mover_.contract(scene_.view(), scene_.plan(), {});
      if (!change_.empty()) return true;
    }
    const int interval = files_.options.layout.renew_interval;
    if (interval == 0 || step % interval) return false;
    if (mover_.renews()) change_ = mover_.renewal(scene_.view());
    return true;
  }

  void write_checkpoint(const solve::LoadPath& path)
  {
    checkpoints_.write(
        {scene_.standing(), scene_.layout(), scene_.dormant(), path, driver_->report(), recorder_, u(), load_});
  }

  void drive(solve::StaticReport before)
  {
    solve::StaticOptions steps = scene::static_options(files_.options, d(), scene_.assembled());
    steps.working = [this](const solve::Step& step) { recorder_.working(driver_->report(), step.load); };
    if (mover_.follows())
      steps.outgrown = [this] {
        change_ = mover_.look(scene_.view(), scene_.plan(), d().fracture->broken(), {});
        return !change_.empty();
      };
    if (mover_.follows()) {
      const scene::Standing standing = scene_.standing();
      const scene::SceneNames names(standing);
      lasting_.names.assign(names.rows().begin(), names.rows().end());
    }
    driver_ = std::make_unique<solve::StaticSolver>(d().system, steps, std::move(before),
                                                    mover_.follows() ? &lasting_ : nullptr);
    recorder_.tell_condensed(driver_->condensation());
  }

  /// Solves until the loads end or the layout is to change.
  Verdict load(solve::LoadPath& path)
  {
    try {
      return driver_->run(
          u(), path,
          [&](const solve::Step& step, Vec state) {
            recorder_.accept(step, state, *driver_, prior_);
            load_ = step.load;
            if (mover_.watches()) files_.warn(mover_.border(scene_.view(), scene_.plan(), d().fracture->broken()));
            if (checkpoints_.due(step.number, path.done())) write_checkpoint(path);
            return change_due(step.number, path) ? Verdict::relayout : Verdict::go_on;
          },
          &open_);
    } catch (const SolverFailure&) {
      recorder_.count(driver_->report());
      files_.after_failure([&] {
        recorder_.stopped_at(u());
        if (checkpoints_.asked() && driver_->report().steps > 0) write_checkpoint(path);
      });
      throw;
    } catch (const UserError& loose) { // the steps that were accepted stay
      recorder_.count(driver_->report());
      files_.after_failure([&] { recorder_.stopped_at(u()); });
      files_.fail(loose.what());
      throw;
    } catch (const Stopped& stop) {
      recorder_.count(driver_->report());
      recorder_.stopped_at(u());
      const int steps = driver_->report().steps;
      std::string words = fmt::format("{} after {} load step{}: results are those of the last of them", stop.what(),
                                      steps, steps == 1 ? "" : "s");
      if (steps > 0) {
        write_checkpoint(path);
        words +=
            fmt::format("; checkpoint written to {}; go on with -restart {}", checkpoints_.file(), checkpoints_.file());
      }
      throw Stopped(words);
    }
  }

  /// The layout to come, or the same, built anew: what stood before is gone, but for what it knew by name. Within a
  /// load the state accepted last goes along, to go back to.
  void renew()
  {
    static Event event("layout_change");
    const Timed timed(event);
    const double begin = MPI_Wtime();
    const NoStop whole; // the next step or load sees a signal that comes now
    const std::vector<double> now_u = field::owned_values(u());
    const change::StaticScene::Moment now = scene_.moment(now_u, change_);
    const double energy = scene_.strain_energy(now_u);
    std::optional<change::StaticScene::Moment> accepted;
    if (open_) {
      for (const auto& after : d().system.after) after->restore();
      accepted = scene_.moment(open_->start, change_);
    }
    solve::StaticReport report = driver_->report();
    driver_.reset();
    if (!change_.empty()) ++files_.summary.relocations;
    mover_.leave_scene();
    if (change_.empty()) mover_.deal_out(files_.comm());
    scene_.rebuild(change_);
    d().system.go_to(load_);
    std::vector<double> start, force; // of the load accepted last
    if (open_) {
      start = open_->start = scene_.take(*accepted, change_);
      for (const auto& after : d().system.after) after->save();
      force = scene_.internal_force(start);
    }
    const std::vector<double> u_now = scene_.take(now, change_);
    scene_.keep_dormant();
    if (open_) d().system.go_to(open_->step.load);
    if (!open_) {
      start = u_now;
      force = scene_.internal_force(start);
    }
    field::set_owned_values(u(), u_now);
    recorder_.book_change(scene_.strain_energy(u_now) - energy);
    recorder_.take_scene(scene_.ground().mesh, d(), load_, start, force);
    drive(std::move(report));
    change_ = {};
    files_.layout_seconds += MPI_Wtime() - begin;
  }

  scene::Discretisation& d() { return scene_.d(); }
  Vec u() const { return scene_.u(); }

  record::RunFiles& files_;
  change::StaticScene scene_;
  record::Recorder recorder_;
  record::Prior prior_;
  change::PatchMover mover_;
  change::StaticCheckpoints checkpoints_;
  adapt::LayoutChange change_;                  // to come
  std::optional<solve::OpenStep> open_;         // a load that it comes within
  solve::Lasting lasting_;                      // from driver to driver
  std::unique_ptr<solve::StaticSolver> driver_; // on scene_
  double load_ = 0.0;                           // accepted last
};
} // namespace

void run_static(record::RunFiles& files, std::shared_ptr<const scene::PointPlan<2>> points)
{
  StaticRun(files, std::move(points)).run();
}
} // namespace pdx::app
