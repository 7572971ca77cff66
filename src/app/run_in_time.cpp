#include "pdx/app/run_in_time.hpp"

#include "pdx/adapt/energy_trial.hpp"
#include "pdx/adapt/hand_back.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/change/checkpoints.hpp"
#include "pdx/change/load_balance.hpp"
#include "pdx/change/patch_mover.hpp"
#include "pdx/record/contact_watch.hpp"
#include "pdx/record/dry_run.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/implicit_driver.hpp"
#include "pdx/solve/kept_momentum.hpp"

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
      : files_(files), implicit_(files.options.time.analysis == options::Analysis::implicit_dynamics), make_(make),
        layout_(scene::Layout::given(files.options)), recorder_(files), look_(files.comm()),
        balance_(files.comm(), files.options.layout.rebalance_threshold), mover_(files.options)
  {
    if (!implicit_) checkpoints_.emplace(files, mover_);
    if (!goes_on()) return;
    layout_ = *checkpoints_->restarted();
    dormant_ = checkpoints_->dormant();
  }

  void run()
  {
    build();
    for (const std::string& warning : scene_->warnings()) files_.warn(warning);
    if (mover_.follows()) files_.warn(mover_.begin(scene_->view(), *scene_->standing().plan));
    recorder_.built(scene_->standing());
    if (checkpoints_) checkpoints_->begin(files_.scene, layout_, *driver_, recorder_);
    recorder_.started(*driver_, limits_);
    if (files_.options.output.dry_run) return try_steps();
    if (goes_on() && change_due()) change(); // a checkpoint is written before
    while (step() == Verdict::relayout) change();
    if (checkpoints_ && !checkpoints_->stopped().empty()) return stop();
    count_changes();
    recorder_.finish(*driver_);
    if (checkpoints_) checkpoints_->finish(*driver_, recorder_);
  }

private:
  /// Steps of which nothing is kept.
  void try_steps()
  {
    const int left = driver_->expected_steps() - driver_->step();
    const double length = driver_->step_length();
    record::DryRun dry(files_);
    dry.fields(driver_->time(), driver_->displacement());
    (void)driver_->run([&] { return dry.step() ? Verdict::go_on : Verdict::stop; });
    const double begin = MPI_Wtime();
    (void)recorder_.energies(*driver_);
    dry.look(MPI_Wtime() - begin);
    dry.tell_time(left, length);
  }

  bool goes_on() const { return checkpoints_ && checkpoints_->restarted(); }
  void change()
  {
    files_.told_if_refused([&] { renew(); });
  }

  void build()
  {
    scene_ = make_(layout_, costs_ ? &*costs_ : nullptr);
    drive();
  }

  void drive()
  {
    const options::TimeOptions& time = files_.options.time;
    limits_ = scene_->limits();
    if (implicit_)
      driver_ = std::make_unique<solve::ImplicitDriver>(scene_->system());
    else
      driver_ = std::make_unique<solve::ExplicitDriver>(
          scene_->system(),
          solve::ExplicitOptions{limits_.rigorous, time.safety, time.allow_unstable, begun_ || goes_on()});
    begun_ = true;
    files_.velocity = driver_->v();
  }

  /// Steps until the run ends or the layout is to change.
  Verdict step()
  {
    try {
      return driver_->run([&] {
        recorder_.after_step(*driver_);
        watch_border();
        watch_contact();
        if (!checkpoints_) {
          look_();
          return Verdict::go_on;
        }
        const Verdict verdict = checkpoints_->after_step(*driver_, recorder_);
        return verdict == Verdict::go_on && change_due() ? Verdict::relayout : verdict;
      });
    } catch (const Stopped& stop) {
      recorder_.stopped_at(*driver_);
      throw Stopped(fmt::format("{} at step {}, time {:.6g} s: implicit steps have no checkpoint", stop.what(),
                                driver_->step(), driver_->time()));
    } catch (const SolverFailure&) {
      files_.after_failure([&] { recorder_.stopped_at(*driver_); });
      if (checkpoints_) files_.after_failure([&] { checkpoints_->failed(*driver_); });
      throw;
    }
  }

  /// Tells when a crack comes to elements that cannot make way for it.
  void watch_border()
  {
    const int step = driver_->step();
    if (mover_.watches() && (step % kBorderSteps == 0 || step == driver_->expected_steps()))
      files_.warn(mover_.border(scene_->view(), *files_.scene.plan, files_.scene.model->breaker->mine().bonds));
  }

  /// Tells when bodies are about to go through each other.
  void watch_contact()
  {
    const int step = driver_->step();
    if (step % kBorderSteps && step != driver_->expected_steps()) return;
    for (const std::string& warning : contact_.look(files_.comm(), *files_.scene.model)) files_.warn(warning);
  }

  /// Is all to be made anew, the mesh to be cut anew for it, or patches to move?
  bool change_due()
  {
    const options::LayoutOptions& when = files_.options.layout;
    const int step = driver_->step();
    if (step >= driver_->expected_steps()) return false;
    change_ = {};
    if (mover_.follows() && step % when.adapt_interval == 0)
      change_ =
          mover_.look(scene_->view(), *files_.scene.plan, files_.scene.model->breaker->mine().bonds, driver_->local());
    if (change_.empty() && mover_.may_hand_back(step)) change_ = mover_.quiet(scene_->view(), driver_->local());
    if (mover_.may_contract()) files_.told_if_refused([&] { add_what_lies_behind(); });
    uneven_ = balance_.due(*driver_) && change_.empty(); // one after the other: what leaves is told by cells
    const bool renewed = when.renew_interval > 0 && step % when.renew_interval == 0;
    if (renewed && mover_.renews() && change_.empty()) change_ = mover_.renewal(scene_->view());
    return uneven_ || renewed || !change_.empty();
  }

  /// Adds to the change to come what patches hand back.
  void add_what_lies_behind()
  {
    const scene::Discretisation& d = *files_.scene.d;
    const post::Energies energies = recorder_.energies(*driver_).stored;
    const std::vector<double> density = d.energy_density(driver_->local());
    const adapt::SceneView view = scene_->view();
    const adapt::EnergyTrial trial(view, {driver_->local(), density, files_.options.elastic,
                                          files_.options.element_kinematics(), kMostRise * energies.elastic()});
    adapt::LayoutChange behind =
        mover_.contract(view, *files_.scene.plan,
                        [&trial](Index cell, const crack::CrackSet& paths) { return trial.allows(cell, paths); });
    behind.cover = std::move(change_.cover);
    change_ = std::move(behind);
  }

  /// Adds the rows that the change to come makes, with what the scene says of them now, and returns what goes.
  adapt::Leaving add_fresh_rows(scene::NamedState& state) const
  {
    std::vector<double> v;
    driver_->moving().system.halo->fetch(driver_->v(), driver_->moving().system.rows.dim, v);
    const std::span<const double> fields[] = {driver_->local(), v};
    const std::vector<couple::PatchShape> shapes = scene::patch_shapes(layout_.changed(change_).in(files_.options));
    scene::add_rows(state, adapt::fill(scene_->view(), change_, shapes, fields));
    return adapt::leaving(scene_->view(), change_.uncover, fields);
  }

  /// Angular momentum of what moves in the plane; patches move nowhere else.
  double spin() const
  {
    const solve::MovingSystem& moving = driver_->moving();
    return moving.system.rows.dim == 2 ? solve::angular_momentum(moving, driver_->local(), driver_->v()) : 0.0;
  }

  /// Another scene, by `layout_`.
  void rebuild(bool same_mesh)
  {
    if (!same_mesh) {
      scene_.reset();
      return build();
    }
    scene_->change(layout_);
    drive();
  }

  /// The layout to come, or the same, built anew, on other ranks if that is due: what stood before is gone, but for
  /// what it knew by name.
  void renew()
  {
    static Event event("layout_change");
    const Timed timed(event);
    const double begin = MPI_Wtime();
    const NoStop whole; // the next step or load sees a signal that comes now
    if (uneven_) costs_ = balance_.costs(files_.scene, *driver_);
    couple::BondBreaker* breaker = files_.scene.model->breaker;
    const pd::Broken broken = breaker ? breaker->mine() : pd::Broken{};
    const solve::TimeDriver::Clock clock = driver_->clock();
    const std::vector<double> sums = files_.scene.model->rank_sums();
    scene::NamedState state = scene::capture(files_.scene, *driver_, recorder_.leave_scene(*driver_));
    const bool moves = !change_.empty();
    const std::size_t known = state.rows.size();
    const std::array<double, 3> momentum = moves ? driver_->moving().momentum(driver_->v()) : std::array<double, 3>{};
    const double angular = moves ? spin() : 0.0;
    adapt::Leaving left;
    if (moves) {
      left = add_fresh_rows(state);
      layout_ = layout_.changed(change_);
      ++files_.summary.relocations;
    }
    balance_.leave(*driver_);
    mover_.leave_scene();
    driver_.reset();
    rebuild(moves && !uneven_);
    scene::add_dormant(files_.comm(), state, dormant_);
    const scene::StateMove move(state, scene_->standing(),
                                moves ? scene::StateMove::From::changed : scene::StateMove::From::same);
    move.require_fit();
    move.break_bonds();
    move.hold_grips();
    dormant_ = move.dormant();
    if (moves) {
      field::State moving = move.moving();
      const std::vector<double> is_new = move.came_after(known);
      const std::span<double> fields[] = {moving.u, moving.v};
      if (!change_.uncover.empty()) adapt::fit_sets(scene_->view(), left, is_new, fields);
      solve::keep_momentum(driver_->moving(), is_new, momentum, moving.v);
      if (driver_->moving().system.rows.dim == 2)
        solve::keep_angular_momentum(driver_->moving(), is_new, angular, moving.u, moving.v);
      driver_->resume_changed(clock, moving);
      if (checkpoints_) checkpoints_->step_is(driver_->step_length());
      if (driver_->step_length() < clock.length) tell_shorter(clock.length);
    } else
      driver_->resume(clock, move.moving());
    breaker = scene_->standing().model->breaker;
    if (breaker) breaker->resume(broken);
    scene_->standing().model->resume_sums(sums);
    recorder_.take_scene(scene_->standing(), *driver_, move.cracks());
    if (checkpoints_) checkpoints_->take_scene(files_.scene, layout_, dormant_, recorder_);
    files_.layout_seconds += MPI_Wtime() - begin;
    if (!uneven_) return;
    files_.progress.line(
        fmt::format("step {}: the busiest rank had {:.2f} times the mean to do; dealt out anew, it should "
                    "be {:.2f}",
                    driver_->step(), balance_.imbalance(), files_.scene.mesh->quality().imbalance));
    balance_.changed(*driver_, files_.scene.mesh->quality().imbalance);
  }

  /// Steps have become shorter: a given length is kept no more, which is worth a warning.
  void tell_shorter(double before)
  {
    const std::string text = fmt::format("step {}: steps of {:.4g} s from here, for the particles that came",
                                         driver_->step(), driver_->step_length());
    PetscBool given = PETSC_FALSE;
    PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-ts_dt", &given));
    if (given)
      files_.warn(fmt::format("{}: the -ts_dt of {:g} s is above the stable limit beside them, {:.4g} s", text, before,
                              limits_.rigorous));
    else
      files_.progress.line(text);
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
    recorder_.interrupted(*driver_);
    files_.stop(checkpoints_->stopped());
  }

  record::RunFiles& files_;
  bool implicit_;
  const scene::SceneMaker& make_;
  scene::Layout layout_;
  record::TimeRecorder recorder_;
  StopLook look_; // of implicit steps
  change::LoadBalance balance_;
  change::PatchMover mover_;
  record::ContactWatch contact_;
  std::optional<change::Checkpoints> checkpoints_;
  adapt::LayoutChange change_; // to come
  scene::Dormant dormant_;
  bool begun_ = false;  // a driver was there
  bool uneven_ = false; // the change to come is for the balance
  std::optional<mesh::MeasuredCosts> costs_;
  std::unique_ptr<scene::Scene> scene_;
  scene::StepLimits limits_;
  std::unique_ptr<solve::TimeDriver> driver_; // on scene_
};
} // namespace

void run_in_time(record::RunFiles& files, const scene::SceneMaker& make) { TimeRun(files, make).run(); }
} // namespace pdx::app
