#include "pdx/app/run.hpp"

#include "pdx/app/crack_results.hpp"
#include "pdx/app/discretisation.hpp"
#include "pdx/app/particle_warnings.hpp"
#include "pdx/app/recorder.hpp"
#include "pdx/app/run_in_time.hpp"
#include "pdx/app/settle.hpp"
#include "pdx/app/support.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/memory.hpp"
#include "pdx/base/options.hpp"
#include "pdx/base/petsc_names.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/solve/static_driver.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <new>

namespace pdx::app {
namespace {
/// Matrix-free unless the user asks for an assembled matrix, by name or by choosing a preconditioner that needs one.
bool wants_assembled(const SceneOptions& options)
{
  if (!options.pd.any() || options.pd.solver == PdOperator::assembled) return true;
  char type[64] = "";
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsGetString(nullptr, nullptr, "-pc_type", type, sizeof type, &given));
  if (!given || solve::works_matrix_free(type)) return false;
  if (options.pd.solver == PdOperator::automatic) return true;
  throw UserError(
      fmt::format("-pc_type {} needs a matrix, but -pd_operator is matrix_free: use assembled, or one of mg, "
                  "pbjacobi, jacobi, none",
                  type));
}

solve::StaticOptions steps_of(const SceneOptions& options, const Discretisation& d, bool assembled)
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
  steps.judge = [&parts = *d.loose_parts, family] { require_support_after_breaking(parts, family); };
  return steps;
}

/// The elements-only solution of the same scene at every local vertex, for Eq. 28.
std::vector<double> reference_displacement(mesh::Mesh& mesh, const SceneOptions& options)
{
  const PauseCounts pause;
  SceneOptions unbroken = options;
  unbroken.fracture = {};
  PatchPlan whole;
  whole.body = options.mesh.box;
  const auto d = discretise(mesh, unbroken, whole, {}, true);
  solve::StaticDriver driver(d->system, steps_of(unbroken, *d, true));
  const VecHandle u = d->system.rows.vector();
  try {
    driver.run(u.get(), [](const solve::Step&, Vec) {});
  } catch (const SolverFailure& failure) {
    throw SolverFailure(fmt::format("the elements-only reference (-post_reference_fe): {}", failure.what()));
  }
  mesh.uncover();
  return d->vertex_displacement(u.get());
}

/// Names of PETSc options that nothing has used, a misspelt one perhaps.
std::string unused_options()
{
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  std::string list;
  PDX_CALL(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  for (PetscInt k = 0; k < count; ++k) {
    const std::string name = std::string("-") + names[k];
    if (is_petsc_family(name) && !is_documented(name)) list += (list.empty() ? "" : ", ") + name;
  }
  PDX_CALL(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return list;
}

void refuse_reference_options(const SceneOptions& options)
{
  if (options.post.reference_fe && !options.pd.any())
    throw UserError("-post_reference_fe compares with the same scene without patches, but there are none: drop it");
}
} // namespace

namespace {
void run_static(RunFiles& files, mesh::Mesh& mesh, const PatchPlan& plan, std::vector<pd::Particle> particles,
                Prior prior)
{
  const SceneOptions& options = files.options;
  const bool assembled = wants_assembled(options);
  Recorder recorder(files);
  if (options.post.energy_release) {
    const PauseCounts pause;
    prior.energy_release = energy_release(mesh, options, plan, particles, assembled);
    cover_cells(mesh, plan, options.mesh);
  }
  const auto d = discretise(mesh, options, plan, std::move(particles), assembled);
  const std::vector<double> at_rest(2 * static_cast<std::size_t>(d->system.halo->size()), 0.0);
  require_contours({mesh, options, plan, *d, at_rest});
  stop_if_told(files.comm());
  recorder.built({&mesh, &plan, d.get()});
  solve::StaticDriver driver(d->system, steps_of(options, *d, assembled));
  const VecHandle u = d->system.rows.vector();
  files.started();
  try {
    driver.run(u.get(), [&](const solve::Step& step, Vec state) { recorder.accept(step, state, driver, prior); });
  } catch (const SolverFailure&) {
    recorder.count(driver.report());
    files.after_failure([&] { recorder.stopped_at(u.get()); });
    throw;
  } catch (const UserError& loose) { // the steps that were accepted stay
    recorder.count(driver.report());
    files.after_failure([&] { recorder.stopped_at(u.get()); });
    files.fail(loose.what());
    throw;
  } catch (const Stopped& stop) {
    recorder.count(driver.report());
    recorder.stopped_at(u.get());
    const int steps = driver.report().steps;
    throw Stopped(fmt::format("{} after {} load step{}: results are those of the last of them", stop.what(), steps,
                              steps == 1 ? "" : "s"));
  }
  recorder.finish(driver.report());
}
} // namespace

namespace {
void run_plane(RunFiles& files)
{
  const SceneOptions& options = files.options;
  mesh::MeshOptions mesh_options = options.mesh;
  const PatchPlan plan = plan_patches(options, mesh_options);
  files.warn(correction_warning(options, plan));
  if (options.pd.everywhere) {
    require_rows(options, plan.shapes[0].lattice.count);
    files.warn(thin_warning(options, plan));
  }
  mesh::Mesh mesh = mesh::build(files.comm(), mesh_options, cell_cost(plan));
  stop_if_told(files.comm());
  Prior prior;
  if (options.post.reference_fe) {
    cover_cells(mesh, plan, mesh_options, options.frame); // refuses a wrong patch before the reference is paid for
    mesh.uncover();
    prior.reference = reference_displacement(mesh, options);
  }
  std::unique_ptr<pd::Particles> swarm;
  std::vector<pd::Particle> particles;
  if (options.pd.any()) {
    cover_cells(mesh, plan, mesh_options, options.frame);
    swarm = std::make_unique<pd::Particles>(files.comm());
    particles = make_particles(mesh, plan, *swarm);
    files.warn(corner_warning(plan, mesh.bounds(), options.frame));
    stop_if_told(files.comm());
  }
  if (options.time.dynamic())
    run_in_time(files, mesh, plan, std::move(particles));
  else
    run_static(files, mesh, plan, std::move(particles), std::move(prior));
}
} // namespace

void run(MPI_Comm comm, double begin)
{
  SceneOptions options = SceneOptions::read();
  refuse_reference_options(options);
  if (!options.time.dynamic()) (void)wants_assembled(options); // refuses before anything is built
  if (options.pd.cloud.empty()) settle(comm, options);
  RunFiles files(comm, options, begin);
  for (const std::string& warning : options.warnings) files.warn(warning);
  try {
    if (!options.pd.cloud.empty())
      run_cloud(files, options);
    else if (options.solid)
      run_solid(files);
    else
      run_plane(files);
    if (const std::string unused = unused_options(); !unused.empty())
      files.warn("options of PETSc that nothing used: " + unused);
  } catch (const UserError&) {
    throw;
  } catch (const SolverFailure& failure) {
    files.fail(failure.what());
    throw;
  } catch (const Stopped& stop) {
    files.stop(stop.what());
  } catch (const std::bad_alloc&) {
    files.lost(memory_ran_out());
    throw;
  } catch (const std::exception& failure) {
    files.lost(failure.what());
    throw;
  }
}

std::string help_text()
{
  (void)SceneOptions::read(true);
  std::string text = fmt::format("pdxsolve {}: brittle fracture with elements and peridynamics\n"
                                 "mpirun -n N pdxsolve -options_file case.opts [any PETSc option]\n",
                                 PDX_VERSION);
  std::string room;
  for (const OptionDoc& doc : documented_options()) {
    if (doc.room != room) text += fmt::format("\n{}\n", room = doc.room);
    text += fmt::format("  {:<28} {}{}\n{:31}default {}; {}\n", doc.name, doc.help,
                        doc.unit.empty() ? "" : " [" + doc.unit + "]", "", doc.default_value, doc.allowed);
  }
  text += "\nBodies and crack faces do not touch: there is no contact, what meets passes through.\n";
  return text +
         "\nSolver options are PETSc's: -snes_..., -ksp_..., -pc_..., -mg_levels_..., -mg_coarse_..., -log_view.\n";
}
} // namespace pdx::app
