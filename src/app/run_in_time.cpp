#include "pdx/app/run_in_time.hpp"

#include "pdx/adapt/energy_trial.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/change/checkpoints.hpp"
#include "pdx/change/load_balance.hpp"
#include "pdx/change/patch_mover.hpp"
#include "pdx/change/time_scene.hpp"
#include "pdx/record/contact_watch.hpp"
#include "pdx/record/dry_run.hpp"

#include <fmt/format.h>
#include <optional>

namespace pdx::app {
namespace {
using Verdict = solve::TimeDriver::Verdict;
constexpr double kMostRise = 2e-4; // of the strain energy, by one element that particles become
constexpr int kBorderSteps = 20;   // from one look at the border of patches that stay, or at contact, to the next

/// What steps a scene through time and records it, with checkpoints where steps are explicit. A scene and its driver
/// live for one layout; files, recorders and checkpoints outlive them.
class TimeRun {
public:
  TimeRun(record::RunFiles& files, const scene::SceneMaker& make)
      : files_(files), scene_(files.comm(), files.options, make), recorder_(files), look_(files.comm()),
        balance_(files.comm(), files.options.layout.rebalance_threshold), mover_(files.options)
  {
    if (files.options.time.analysis != options::Analysis::implicit_dynamics) checkpoints_.emplace(files, mover_);
    if (goes_on()) scene_.begin_with(*checkpoints_->restarted(), checkpoints_->dormant());
  }

  void run()
  {
    scene_.build();
    files_.velocity = driver().v();
    for (const std::string& warning : scene_.warnings()) files_.warn(warning);
    if (mover_.follows())
      files_.warn(scene_.space() ? mover_.begin(*scene_.space()) : mover_.begin(scene_.view(), scene_.patches()));
    recorder_.built(scene_.standing());
    if (checkpoints_) checkpoints_->begin(files_.scene, scene_.layout(), driver(), recorder_);
    recorder_.started(driver(), scene_.limits());
    if (files_.options.output.dry_run) return try_steps();
    if (goes_on() && change_due()) change(); // a checkpoint is written before
    while (step() == Verdict::relayout) change();
    if (checkpoints_ && !checkpoints_->stopped().empty()) return stop();
    count_changes();
    recorder_.finish(driver());
    if (checkpoints_) checkpoints_->finish(driver(), recorder_);
  }

private:
  /// Steps of which nothing is kept.
  void try_steps()
  {
    const int left = driver().expected_steps() - driver().step();
    const double length = driver().step_length();
    record::DryRun dry(files_);
    dry.fields(driver().time(), driver().displacement());
    (void)driver().run([&] { return dry.step() ? Verdict::go_on : Verdict::stop; });
    const double begin = MPI_Wtime();
    (void)recorder_.energies(driver());
    dry.look(MPI_Wtime() - begin);
    dry.tell_time(left, length);
  }

  solve::TimeDriver& driver() { return scene_.driver(); }
  bool goes_on() const { return checkpoints_ && checkpoints_->restarted(); }
  void change()
  {
    files_.told_if_refused([&] { renew(); });
  }

  /// Steps until the run ends or the layout is to change.
  Verdict step()
  {
    try {
      return driver().run([&] {
        recorder_.after_step(driver());
        watch_border();
        watch_contact();
        if (!checkpoints_) {
          look_();
          return Verdict::go_on;
        }
        const Verdict verdict = checkpoints_->after_step(driver(), recorder_);
        return verdict == Verdict::go_on && change_due() ? Verdict::relayout : verdict;
      });
    } catch (const Stopped& stop) {
      recorder_.stopped_at(driver());
      throw Stopped(fmt::format("{} at step {}, time {:.6g} s: implicit steps have no checkpoint", stop.what(),
                                driver().step(), driver().time()));
    } catch (const SolverFailure&) {
      files_.after_failure([&] { recorder_.stopped_at(driver()); });
      if (checkpoints_) files_.after_failure([&] { checkpoints_->failed(driver()); });
      throw;
    }
  }

  /// Tells when a crack comes to elements that cannot make way for it.
  void watch_border()
  {
    const int step = driver().step();
    if (mover_.watches() && (step % kBorderSteps == 0 || step == driver().expected_steps()))
      files_.warn(mover_.border(scene_.view(), scene_.patches(), files_.scene.model->breaker->mine().bonds));
  }

  /// Tells when bodies are about to go through each other.
  void watch_contact()
  {
    const int step = driver().step();
    if (step % kBorderSteps && step != driver().expected_steps()) return;
    for (const std::string& warning : contact_.look(files_.comm(), *files_.scene.model)) files_.warn(warning);
  }

  /// Is all to be made anew, the mesh to be cut anew for it, or patches to move?
  bool change_due()
  {
    const options::LayoutOptions& when = files_.options.layout;
    const int step = driver().step();
    if (step >= driver().expected_steps()) return false;
    change_ = {};
    if (mover_.follows() && step % when.adapt_interval == 0) change_ = look();
    if (change_.empty() && mover_.may_hand_back(step)) change_ = mover_.quiet(scene_.view(), driver().local());
    if (mover_.may_contract()) files_.told_if_refused([&] { add_what_lies_behind(); });
    uneven_ = balance_.due(driver()) && change_.empty(); // one after the other: what leaves is told by cells
    const bool renewed = when.renew_interval > 0 && step % when.renew_interval == 0;
    if (renewed && mover_.renews() && change_.empty()) change_ = mover_.renewal(scene_.view());
    return uneven_ || renewed || !change_.empty();
  }

  adapt::LayoutChange look()
  {
    const std::int64_t broken = files_.scene.model->breaker->mine().bonds;
    if (const adapt::SpaceView* space = scene_.space()) return mover_.look(*space, broken, driver().local());
    return mover_.look(scene_.view(), scene_.patches(), broken, driver().local());
  }

  /// Adds to the change to come what patches hand back.
  void add_what_lies_behind()
  {
    const post::Energies energies = recorder_.energies(driver()).stored;
    const adapt::SceneView view = scene_.view();
    const std::vector<double> density = adapt::energy_density(view, driver().local());
    const adapt::EnergyTrial trial(view, {driver().local(), density, files_.options.elastic,
                                          files_.options.element_kinematics(), kMostRise * energies.elastic(),
                                          files_.options.regions.get()});
    adapt::LayoutChange behind =
        mover_.contract(view, scene_.patches(),
                        [&trial](Index cell, const crack::CrackSet& paths) { return trial.allows(cell, paths); });
    behind.cover = std::move(change_.cover);
    change_ = std::move(behind);
  }

  /// The layout to come, or the same, built anew, on other ranks if that is due: what stood before is gone, but for
  /// what it knew by name.
  void renew()
  {
    static Event event("layout_change");
    const Timed timed(event);
    const double begin = MPI_Wtime();
    const NoStop whole; // the next step or load sees a signal that comes now
    std::optional<mesh::MeasuredCosts> costs;
    if (uneven_) costs = balance_.costs(files_.scene, driver());
    scene_.foresee(change_);
    change::TimeScene::Moment moment = scene_.moment(change_, recorder_.leave_scene(driver(), !change_.empty()));
    const double length = moment.clock.length;
    if (!change_.empty()) ++files_.summary.relocations;
    balance_.leave(driver());
    mover_.leave_scene();
    if (change_.empty()) mover_.deal_out(files_.comm()); // else cells stay where they are
    scene_.rebuild(change_, std::move(costs), moment);
    files_.velocity = driver().v();
    const std::optional<scene::CrackNotes> cracks = scene_.take(std::move(moment), change_);
    if (!change_.empty()) {
      if (checkpoints_) checkpoints_->step_is(driver().step_length());
      if (driver().step_length() < length) recorder_.tell_shorter(driver(), length, scene_.limits().rigorous);
    }
    recorder_.take_scene(scene_.standing(), driver(), cracks);
    scene_.settle();
    if (checkpoints_) checkpoints_->take_scene(files_.scene, scene_.layout(), scene_.dormant(), recorder_);
    files_.layout_seconds += MPI_Wtime() - begin;
    if (!uneven_) return;
    const double imbalance = files_.scene.mesh->quality().imbalance;
    files_.progress.line(
        fmt::format("step {}: the busiest rank had {:.2f} times the mean to do; dealt out anew, it should "
                    "be {:.2f}",
                    driver().step(), balance_.imbalance(), imbalance));
    balance_.changed(driver(), imbalance);
  }

  void count_changes()
  {
    if (files_.options.layout.rebalance_threshold <= 0.0) return;
    auto& results = files_.summary.results;
    results["rebalances"] = balance_.changes();
    results["imbalance"] = balance_.imbalance();
  }

  /// A signal ended the run, and a checkpoint was written.
  void stop()
  {
    count_changes();
    recorder_.interrupted(driver());
    files_.stop(checkpoints_->stopped());
  }

  record::RunFiles& files_;
  change::TimeScene scene_;
  record::TimeRecorder recorder_;
  StopLook look_; // of implicit steps
  change::LoadBalance balance_;
  change::PatchMover mover_;
  record::ContactWatch contact_;
  std::optional<change::Checkpoints> checkpoints_;
  adapt::LayoutChange change_; // to come
  bool uneven_ = false;        // it is for the balance
};
} // namespace

void run_in_time(record::RunFiles& files, const scene::SceneMaker& make) { TimeRun(files, make).run(); }
} // namespace pdx::app
