#include "pdx/app/run_static.hpp"

#include "pdx/adapt/hand_back.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/change/patch_mover.hpp"
#include "pdx/change/static_checkpoints.hpp"
#include "pdx/record/crack_results.hpp"
#include "pdx/record/dry_run.hpp"
#include "pdx/record/recorder.hpp"
#include "pdx/scene/particle_warnings.hpp"
#include "pdx/scene/scene.hpp"
#include "pdx/scene/support.hpp"
#include "pdx/solve/static_driver.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace pdx::app {
bool wants_assembled(const options::SceneOptions& options)
{
  if (!options.pd.any() || options.points.any() || options.pd.solver == options::PdOperator::assembled) return true;
  char type[64] = "";
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsGetString(nullptr, nullptr, "-pc_type", type, sizeof type, &given));
  if (!given || solve::works_matrix_free(type)) return false;
  if (options.pd.solver == options::PdOperator::automatic) return true;
  throw UserError(
      fmt::format("-pc_type {} needs a matrix, but -pd_operator is matrix_free: use assembled, or one of mg, "
                  "pbjacobi, jacobi, none",
                  type));
}

namespace {
using solve::Verdict;

solve::StaticOptions steps_of(const options::SceneOptions& options, const scene::Discretisation& d, bool assembled)
{
  solve::StaticOptions steps;
  steps.load_steps = options.load.steps;
  steps.assembled = assembled;
  steps.max_passes = options.load.passes;
  steps.max_halvings = options.load.halvings;
  if (!d.fracture) return steps;
  steps.max_changes =
      std::max<std::int64_t>(1, std::llround(options.load.broken_share * static_cast<double>(d.bonds_at_start)));
  Index family = 0; // as many particles may come off together
  for (const auto& part : d.bonds->parts())
    family = std::max(family, static_cast<Index>(2 * part->stencil().half.size()));
  steps.judge = [&parts = *d.loose_parts, family, &frame = options.frame] {
    scene::require_support_after_breaking(parts, family, frame);
  };
  return steps;
}

/// The elements-only solution of the same scene at every local vertex, for Eq. 28.
std::vector<double> reference_displacement(mesh::Mesh& mesh, const options::SceneOptions& options)
{
  const PauseCounts pause;
  options::SceneOptions unbroken = options;
  unbroken.fracture = {};
  scene::PatchPlan whole;
  whole.body = options.mesh.box;
  const auto d = scene::discretise(mesh, unbroken, whole, {}, true);
  solve::StaticDriver driver(d->system, steps_of(unbroken, *d, true));
  const VecHandle u = d->system.rows.vector();
  try {
    driver.run(u.get(), [](const solve::Step&, Vec) { return Verdict::go_on; });
  } catch (const SolverFailure& failure) {
    throw SolverFailure(fmt::format("the elements-only reference (-post_reference_fe): {}", failure.what()));
  }
  mesh.uncover();
  return d->vertex_displacement(u.get());
}

/// A scene under growing loads and what records it. The scene and its driver live for one layout; files, recorder and
/// the path of loads outlive them.
class StaticRun {
public:
  StaticRun(record::RunFiles& files, std::shared_ptr<const scene::PointPlan<2>> points)
      : files_(files), points_(std::move(points)), assembled_(wants_assembled(files.options)),
        layout_(scene::Layout::given(files.options)), recorder_(files), mover_(files.options),
        checkpoints_(files, mover_)
  {
    if (!checkpoints_.goes_on()) return;
    layout_ = checkpoints_.layout();
    dormant_ = checkpoints_.dormant();
  }

  void run()
  {
    lay();
    for (const std::string& warning : ground_->warnings()) files_.warn(warning);
    files_.warn(scene::region_warning(ground_->options, ground_->mesh, ground_->particles));
    build();
    const std::vector<double> at_rest(2 * static_cast<std::size_t>(d_->system.halo->size()), 0.0);
    record::require_contours({ground_->mesh, files_.options, ground_->plan, *d_, at_rest});
    stop_if_told(files_.comm());
    if (mover_.follows()) files_.warn(mover_.begin(d_->view(ground_->mesh), ground_->plan));
    recorder_.built(standing());
    solve::LoadPath path(files_.options.load.steps, files_.options.load.halvings);
    if (checkpoints_.goes_on())
      resume(path);
    else
      drive({});
    files_.started();
    files_.begin_probes(driver_->report().steps, load_, u_.get());
    if (files_.options.output.dry_run) return try_solve(path);
    if (path.done())
      recorder_.stopped_at(u_.get()); // there is nothing left to do
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
    dry.fields(0.0, u_.get());
    const auto breaking = std::exchange(d_->system.after, {});
    const double begin = MPI_Wtime();
    (void)driver_->run(u_.get(), path, [](const solve::Step&, Vec) { return Verdict::stop; });
    dry.solve(MPI_Wtime() - begin);
    dry.tell_loads(files_.options.load.steps, driver_->report().linear_iterations);
  }

  scene::Standing standing() { return {&ground_->mesh, &ground_->plan, d_.get()}; }

  /// The ground of the first scene, and what is solved on it before.
  void lay()
  {
    const options::SceneOptions& options = files_.options;
    ground_ = std::make_unique<scene::Ground>(files_.comm(), layout_.in(options), nullptr, points_);
    if (options.post.reference_fe) {
      scene::cover_cells(ground_->mesh, ground_->plan, ground_->mesh_options,
                         options.frame); // refuses wrong patches first
      ground_->mesh.uncover();
      const double begin = MPI_Wtime();
      prior_.reference = reference_displacement(ground_->mesh, options);
      files_.solved_before += MPI_Wtime() - begin;
    }
    ground_->lay_particles();
    if (!options.post.energy_release) return;
    const PauseCounts pause;
    const double begin = MPI_Wtime();
    prior_.energy_release =
        record::energy_release(ground_->mesh, options, ground_->plan, ground_->particles, assembled_);
    files_.solved_before += MPI_Wtime() - begin;
    scene::cover_cells(ground_->mesh, ground_->plan, options.mesh);
  }

  /// From a checkpoint: the scene stands as it was laid there.
  void resume(solve::LoadPath& path)
  {
    change::StaticCheckpoints::Start start = checkpoints_.start(standing(), path);
    load_ = start.load;
    field::set_owned_values(u_.get(), start.u);
    const std::vector<double> force = internal_force(start.u);
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
      change_ = mover_.contract(d_->view(ground_->mesh), ground_->plan, {});
      if (!change_.empty()) return true;
    }
    const int interval = files_.options.layout.renew_interval;
    if (interval == 0 || step % interval) return false;
    if (mover_.renews()) change_ = mover_.renewal(d_->view(ground_->mesh));
    return true;
  }

  void write_checkpoint(const solve::LoadPath& path)
  {
    checkpoints_.write({standing(), layout_, dormant_, path, driver_->report(), recorder_, u_.get(), load_});
  }

  void build()
  {
    d_ = scene::discretise(ground_->mesh, ground_->options, ground_->plan, std::move(ground_->particles), assembled_,
                           points_.get());
    u_ = d_->system.rows.vector();
  }

  void drive(solve::StaticReport before)
  {
    solve::StaticOptions steps = steps_of(files_.options, *d_, assembled_);
    steps.working = [this](const solve::Step& step) { recorder_.working(driver_->report(), step.load); };
    if (mover_.follows())
      steps.outgrown = [this] {
        change_ = mover_.look(d_->view(ground_->mesh), ground_->plan, d_->fracture->broken(), {});
        return !change_.empty();
      };
    driver_ = std::make_unique<solve::StaticDriver>(d_->system, steps, std::move(before));
  }

  /// Solves until the loads end or the layout is to change.
  Verdict load(solve::LoadPath& path)
  {
    try {
      return driver_->run(
          u_.get(), path,
          [&](const solve::Step& step, Vec state) {
            recorder_.accept(step, state, *driver_, prior_);
            load_ = step.load;
            if (mover_.watches())
              files_.warn(mover_.border(d_->view(ground_->mesh), ground_->plan, d_->fracture->broken()));
            if (checkpoints_.due(step.number, path.done())) write_checkpoint(path);
            return change_due(step.number, path) ? Verdict::relayout : Verdict::go_on;
          },
          &open_);
    } catch (const SolverFailure&) {
      recorder_.count(driver_->report());
      files_.after_failure([&] {
        recorder_.stopped_at(u_.get());
        if (checkpoints_.asked() && driver_->report().steps > 0) write_checkpoint(path);
      });
      throw;
    } catch (const UserError& loose) { // the steps that were accepted stay
      recorder_.count(driver_->report());
      files_.after_failure([&] { recorder_.stopped_at(u_.get()); });
      files_.fail(loose.what());
      throw;
    } catch (const Stopped& stop) {
      recorder_.count(driver_->report());
      recorder_.stopped_at(u_.get());
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

  /// A state of the scene, and of the rows to come.
  struct Moment {
    scene::NamedState state;
    pd::Broken broken;
    std::size_t known = 0; // rows that were there before
    adapt::Leaving left;
  };
  Moment moment(std::span<const double> u)
  {
    Moment now{scene::capture(standing()), d_->fracture ? d_->fracture->all() : pd::Broken{}, 0, {}};
    now.known = now.state.rows.size();
    now.state.moving.u.assign(u.begin(), u.end());
    if (!change_.empty()) {
      std::vector<double> local;
      d_->system.halo->fetch(u, now.state.dim, local);
      const std::span<const double> fields[] = {local};
      scene::add_rows(now.state, adapt::fill(d_->view(ground_->mesh), change_,
                                             scene::patch_shapes(layout_.changed(change_).in(files_.options)), fields));
      now.left = adapt::leaving(d_->view(ground_->mesh), change_.uncover, fields);
    }
    scene::add_dormant(files_.comm(), now.state, dormant_); // to the rows that are new, too
    return now;
  }

  /// Strain energy of all ranks [J].
  double strain_energy(std::span<const double> u) const
  {
    std::vector<double> local;
    d_->system.halo->fetch(u, d_->system.rows.dim, local);
    double energy = d_->energies(local).elastic();
    MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, files_.comm());
    return energy;
  }

  std::vector<double> internal_force(std::span<const double> u) const
  {
    std::vector<double> local, force(u.size(), 0.0);
    d_->system.halo->fetch(u, d_->system.rows.dim, local);
    for (const auto& term : d_->system.terms) term->add_residual(local, force);
    return force;
  }

  /// Takes over what is broken, and returns the displacement.
  std::vector<double> take(const scene::StateMove& move, const Moment& moment)
  {
    move.require_fit();
    move.break_bonds();
    if (d_->fracture) d_->fracture->resume(moment.broken);
    std::vector<double> u = move.rows(moment.state.moving.u, moment.state.dim);
    const std::span<double> fields[] = {u};
    if (!change_.uncover.empty())
      adapt::fit_sets(d_->view(ground_->mesh), moment.left, move.came_after(moment.known), fields);
    return u;
  }

  /// The layout to come, or the same, built anew: what stood before is gone, but for what it knew by name. Within a
  /// load the state accepted last goes along, to go back to.
  void renew()
  {
    static Event event("layout_change");
    const Timed timed(event);
    const double begin = MPI_Wtime();
    const NoStop whole; // the next step or load sees a signal that comes now
    const Moment now = moment(field::owned_values(u_.get()));
    const double energy = strain_energy(field::owned_values(u_.get()));
    std::optional<Moment> accepted;
    if (open_) {
      for (const auto& after : d_->system.after) after->restore();
      accepted = moment(open_->start);
    }
    solve::StaticReport report = driver_->report();
    driver_.reset();
    d_.reset();
    rebuild();
    const scene::StateMove::From before =
        change_.empty() ? scene::StateMove::From::same : scene::StateMove::From::changed;
    std::vector<double> start, force; // of the load accepted last
    if (open_) {
      start = open_->start = take(scene::StateMove(accepted->state, standing(), before), *accepted);
      for (const auto& after : d_->system.after) after->save();
      force = internal_force(start);
    }
    const scene::StateMove move(now.state, standing(), before);
    const std::vector<double> u = take(move, now);
    if (!open_) {
      start = u;
      force = internal_force(start);
    }
    field::set_owned_values(u_.get(), u);
    recorder_.book_change(strain_energy(u) - energy);
    dormant_ = move.dormant();
    recorder_.take_scene(standing(), load_, start, force);
    drive(std::move(report));
    change_ = {};
    files_.layout_seconds += MPI_Wtime() - begin;
  }

  void rebuild()
  {
    if (change_.empty()) {
      ground_ = std::make_unique<scene::Ground>(files_.comm(), layout_.in(files_.options), nullptr, points_);
      ground_->lay_particles();
    } else {
      layout_ = layout_.changed(change_);
      ++files_.summary.relocations;
      ground_->lay_again(layout_.in(ground_->options));
    }
    build();
  }

  record::RunFiles& files_;
  std::shared_ptr<const scene::PointPlan<2>> points_; // null without them
  bool assembled_;
  scene::Layout layout_;
  record::Recorder recorder_;
  record::Prior prior_;
  change::PatchMover mover_;
  change::StaticCheckpoints checkpoints_;
  adapt::LayoutChange change_; // to come
  scene::Dormant dormant_;
  std::optional<solve::OpenStep> open_; // a load that it comes within
  std::unique_ptr<scene::Ground> ground_;
  std::unique_ptr<scene::Discretisation> d_;    // on ground_
  std::unique_ptr<solve::StaticDriver> driver_; // on d_
  VecHandle u_;
  double load_ = 0.0; // accepted last
};
} // namespace

void run_static(record::RunFiles& files, std::shared_ptr<const scene::PointPlan<2>> points)
{
  StaticRun(files, std::move(points)).run();
}
} // namespace pdx::app
