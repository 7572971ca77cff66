#include "pdx/solve/static_driver.hpp"

#include "pdx/base/events.hpp"
#include "pdx/solve/reasons.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <utility>

namespace pdx::solve {
namespace {
constexpr double kRelativeTolerance = 1e-10; // of the true residual norm
constexpr PetscInt kMostIterations = 2000, kGmresRestart = 60;
constexpr const char* kUnstable =
    "unstable growth: bonds go on breaking at this load; under forces there may be no equilibrium beyond it (prescribe "
    "displacements instead), else allow smaller increments; what stopped it: ";

bool given(const char* option)
{
  PetscBool set = PETSC_FALSE;
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, option, &set));
  return set;
}
} // namespace

StaticDriver::StaticDriver(const field::System& system, const StaticOptions& options, StaticReport before)
    : system_(system), options_(options), tangent_(system, options.assembled || !system.coarse),
      look_(system.rows.comm), rule_(options.rebuild_factor), start_(system.rows.vector()), report_(std::move(before)),
      assemblies_before_(report_.jacobian_assemblies)
{
  if (!tangent_.assembled()) two_level_ = std::make_unique<TwoLevel>(system, tangent_);
  configure();
}

void StaticDriver::configure()
{
  const VecHandle r = system_.rows.vector();
  PDX_CALL(SNESCreate(system_.rows.comm, snes_.out()));
  SNES snes = snes_.get();
  PDX_CALL(SNESSetFunction(snes, r.get(), residual, this));
  PDX_CALL(SNESSetJacobian(snes, tangent_.matrix(), tangent_.matrix(), jacobian, this));
  PDX_CALL(SNESSetType(snes, system_.linear() ? SNESKSPONLY : SNESNEWTONLS));
  PDX_CALL(SNESSetTolerances(snes, 1e-50, 1e-9, 1e-14, 50, 10000));
  PDX_CALL(SNESMonitorSet(snes, record, this, nullptr));
  if (system_.linear()) {
    PDX_CALL(SNESSetLagJacobian(snes, -2));
    PDX_CALL(SNESSetLagJacobianPersists(snes, PETSC_TRUE));
  }
  if (options_.full_steps) {
    SNESLineSearch search = nullptr;
    PDX_CALL(SNESGetLineSearch(snes, &search));
    PDX_CALL(SNESLineSearchSetType(search, SNESLINESEARCHBASIC));
  }
  PDX_CALL(SNESGetKSP(snes, &ksp_));
  PDX_CALL(KSPSetType(ksp_, system_.symmetric() ? KSPCG : KSPGMRES));
  if (!system_.symmetric()) {
    PDX_CALL(KSPGMRESSetRestart(ksp_, kGmresRestart));
    PDX_CALL(KSPSetPCSide(ksp_, PC_RIGHT));
  }
  PDX_CALL(KSPSetTolerances(ksp_, kRelativeTolerance, PETSC_DEFAULT, PETSC_DEFAULT, kMostIterations));
  PDX_CALL(KSPSetNormType(ksp_, KSP_NORM_UNPRECONDITIONED));
  PDX_CALL(KSPGetPC(ksp_, &pc_));
  if (two_level_)
    two_level_->configure(pc_);
  else
    PDX_CALL(PCSetType(pc_, PCHYPRE));
  PDX_CALL(KSPMonitorSet(ksp_, look, this, nullptr));
  PDX_CALL(SNESSetFromOptions(snes));
  refuse_wrong_krylov(ksp_, system_.symmetric());
  KSPType krylov = nullptr;
  PDX_CALL(KSPGetType(ksp_, &krylov));
  follows_ = std::string_view(krylov) == KSPPREONLY;
  lags_jacobian_ = given("-snes_lag_jacobian");
  lags_preconditioner_ = given("-snes_lag_preconditioner");
  const bool warm = options_.load_steps > 1 || !system_.after.empty();
  own_krylov_tolerance_ = warm && !given("-ksp_rtol") && !given("-ksp_atol");
  own_newton_tolerance_ = warm && !given("-snes_rtol") && !given("-snes_atol");
}

void StaticDriver::prescribe(Vec u, double load) const
{
  double* values = nullptr;
  PDX_CALL(VecGetArray(u, &values));
  const auto& [components, targets] = system_.prescribed;
  for (std::size_t k = 0; k < components.size(); ++k) values[components[k]] = load * targets[k];
  PDX_CALL(VecRestoreArray(u, &values));
}

std::vector<double> unbalanced_force(const field::System& system, std::span<const double> owned, double load,
                                     std::vector<double>& local)
{
  system.halo->fetch(owned, system.rows.dim, local);
  std::vector<double> r(system.load.size());
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = -load * system.load[k];
  for (const auto& term : system.terms) term->add_residual(local, r);
  return r;
}

/// Forces see prescribed components at their targets, whatever u holds there: so the tangent with their rows and
/// columns taken out is the residual's derivative.
PetscErrorCode StaticDriver::residual(SNES, Vec u, Vec r, void* context)
{
  return guard([&] {
    static Event event("solve_residual");
    Timed timed(event);
    auto* self = static_cast<StaticDriver*>(context);
    const auto& [components, targets] = self->system_.prescribed;
    double* to = nullptr;
    const double* at = nullptr;
    PDX_CALL(VecGetArrayRead(u, &at));
    std::vector<double> state(at, at + self->system_.load.size());
    for (std::size_t k = 0; k < components.size(); ++k)
      state[static_cast<std::size_t>(components[k])] = self->load_ * targets[k];
    std::vector<double> force = unbalanced_force(self->system_, state, self->load_, self->local_);
    self->tangent_.drop_held(force);
    PDX_CALL(VecGetArrayWrite(r, &to));
    std::copy(force.begin(), force.end(), to);
    for (std::size_t k = 0; k < components.size(); ++k)
      to[components[k]] = self->system_.scale * (at[components[k]] - self->load_ * targets[k]);
    if (std::exchange(self->new_load_, false)) self->set_tolerances(force, {to, force.size()});
    PDX_CALL(VecRestoreArrayRead(u, &at));
    PDX_CALL(VecRestoreArrayWrite(r, &to));
  });
}

/// A warm start leaves a small residual; what counts is its size beside the forces at this load: loads and reactions,
/// or the residual that the new load made.
/// @param force internal force - load of all components [N]
void StaticDriver::set_tolerances(std::span<const double> force, std::span<const double> residual)
{
  if (!own_krylov_tolerance_ && !own_newton_tolerance_) return;
  std::vector<double> outer(system_.load.size());
  for (std::size_t k = 0; k < outer.size(); ++k) outer[k] = load_ * system_.load[k];
  for (const Index k : system_.prescribed.components)
    outer[static_cast<std::size_t>(k)] += force[static_cast<std::size_t>(k)];
  double squares[2] = {std::inner_product(outer.begin(), outer.end(), outer.begin(), 0.0),
                       std::inner_product(residual.begin(), residual.end(), residual.begin(), 0.0)};
  MPI_Allreduce(MPI_IN_PLACE, squares, 2, MPI_DOUBLE, MPI_SUM, system_.rows.comm);
  const double reference = std::sqrt(std::max(squares[0], squares[1]));
  PetscReal relative = 0.0;
  if (own_krylov_tolerance_) {
    PDX_CALL(KSPGetTolerances(ksp_, &relative, nullptr, nullptr, nullptr));
    PDX_CALL(KSPSetTolerances(ksp_, PETSC_DEFAULT, relative * reference, PETSC_DEFAULT, PETSC_DEFAULT));
  }
  if (own_newton_tolerance_) {
    PDX_CALL(SNESGetTolerances(snes_.get(), nullptr, &relative, nullptr, nullptr, nullptr));
    PDX_CALL(SNESSetTolerances(snes_.get(), relative * reference, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT,
                               PETSC_DEFAULT));
  }
}

PetscErrorCode StaticDriver::jacobian(SNES, Vec u, Mat operator_matrix, Mat, void* context)
{
  return guard([&] {
    auto* self = static_cast<StaticDriver*>(context);
    self->system_.halo->gather(u, self->local_);
    if (!std::exchange(self->tangent_is_there_, false)) self->tangent_.update(self->local_);
    self->renew_preconditioner();
    if (operator_matrix != self->tangent_.matrix()) { // -snes_mf_operator
      PDX_CALL(MatAssemblyBegin(operator_matrix, MAT_FINAL_ASSEMBLY));
      PDX_CALL(MatAssemblyEnd(operator_matrix, MAT_FINAL_ASSEMBLY));
    }
  });
}

/// Tells PETSc, which asks after each tangent, whether to keep the preconditioner.
void StaticDriver::renew_preconditioner()
{
  const bool build = lags_preconditioner_ || follows_ || rule_.wants_build();
  if (!lags_preconditioner_) PDX_CALL(SNESSetLagPreconditioner(snes_.get(), build ? -2 : -1));
  if (!build) return;
  if (two_level_) two_level_->update(pc_, local_);
  rule_.built();
  built_at_ = tangent_.assemblies();
  held_at_build_ = tangent_.held_rows();
  ++report_.preconditioner_builds;
}

void StaticDriver::judge_preconditioner(double first_residual)
{
  PetscInt iterations = 0;
  PetscReal last_residual = 0.0;
  KSPNormType type = KSP_NORM_DEFAULT;
  PDX_CALL(KSPGetIterationNumber(ksp_, &iterations));
  PDX_CALL(KSPGetResidualNorm(ksp_, &last_residual));
  PDX_CALL(KSPGetNormType(ksp_, &type));
  const bool comparable = type == KSP_NORM_UNPRECONDITIONED && first_residual > 0.0 && last_residual > 0.0;
  rule_.solved(iterations, comparable ? std::log10(first_residual / last_residual) : 1.0);
}

PetscErrorCode StaticDriver::record(SNES, PetscInt iteration, PetscReal norm, void* context)
{
  return guard([&] {
    auto* self = static_cast<StaticDriver*>(context);
    std::vector<double>& norms = self->report_.norms.back();
    if (iteration > 0) self->judge_preconditioner(norms.back());
    norms.push_back(norm);
  });
}

PetscErrorCode StaticDriver::look(KSP, PetscInt, PetscReal, void* context)
{
  return guard([&] { static_cast<StaticDriver*>(context)->look_(); });
}

/// The residual drops what hits rows without stiffness, so the tangent that knows them comes first.
void StaticDriver::prepare(Vec u)
{
  if (stale_) {
    system_.halo->gather(u, local_);
    tangent_.update(local_);
    // Holding a row adds stiffness, which the kept smoother does not know.
    if (tangent_.held_rows() > held_at_build_) rule_.demand();
  }
  const bool again = stale_ || (system_.linear() && rule_.wants_build() && preconditioner_is_behind());
  tangent_is_there_ = again;
  stale_ = false;
  if (again && system_.linear() && !lags_jacobian_) PDX_CALL(SNESSetLagJacobian(snes_.get(), -2));
}

/// @return why it failed, "" if it did not
std::string StaticDriver::attempt(Vec u)
{
  PetscInt newton = 0, linear = 0;
  const double begin = MPI_Wtime();
  report_.norms.emplace_back();
  prescribe(u, load_);
  prepare(u);
  try {
    PDX_CALL(SNESSolve(snes_.get(), nullptr, u));
  } catch (...) {
    snes_.abandon(); // left half done; to destroy it is a fault in 3.22 on 2 ranks
    throw;
  }
  report_.solve_seconds.push_back(MPI_Wtime() - begin);
  report_.solve_changes.push_back(0);
  report_.seconds += report_.solve_seconds.back();
  PDX_CALL(SNESGetIterationNumber(snes_.get(), &newton));
  PDX_CALL(SNESGetLinearSolveIterations(snes_.get(), &linear));
  ++report_.solves;
  report_.newton_iterations += newton;
  report_.linear_iterations += linear;
  report_.solve_iterations.push_back(linear);
  report_.jacobian_assemblies = assemblies_before_ + tangent_.assemblies();
  report_.held_rows = tangent_.held_rows();
  return reason_of_failure(snes_.get());
}

std::string StaticDriver::repeat(Vec u)
{
  PDX_CALL(VecCopy(start_.get(), u));
  return attempt(u);
}

/// If the linear solver fails, the preconditioner may be too old; or the smoother's fast interval may be too short for
/// this scene, or sweeps of multigrid too fast: once, with the safe ones.
std::string StaticDriver::solve(Vec u)
{
  static Event event("solve_load");
  Timed timed(event);
  PDX_CALL(VecCopy(u, start_.get()));
  const auto linear_solver_failed = [&] {
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    PDX_CALL(KSPGetConvergedReason(ksp_, &reason));
    return reason < 0;
  };
  std::string why = attempt(u);
  if (!why.empty() && linear_solver_failed() && !follows_ && preconditioner_is_behind()) {
    rule_.demand();
    follows_ = true;
    why = repeat(u);
    follows_ = false;
  }
  if (!why.empty() && linear_solver_failed() && two_level_ && two_level_->widen(pc_)) why = repeat(u);
  if (!why.empty() && linear_solver_failed() && !two_level_ && sweep_safely(pc_)) {
    rule_.demand();
    stale_ = true;
    why = repeat(u);
  }
  return why;
}

/// @return why there is none, "" if all AfterSolves are quiet
std::string StaticDriver::equilibrium(Step& step, Vec u)
{
  load_ = step.load;
  system_.go_to(load_);
  new_load_ = true;
  outgrown_ = false;
  const int before = report_.linear_iterations - step.iterations;
  for (std::int64_t changes = 1; changes > 0; step.changes += changes) {
    if (step.passes == options_.max_passes)
      return fmt::format("it is not quiet after {} passes; allow more passes or halvings", step.passes);
    ++step.passes;
    const std::string why = solve(u);
    step.iterations = report_.linear_iterations - before;
    if (!why.empty()) return why;
    changes = 0;
    if (system_.after.empty()) break;
    system_.halo->gather(u, local_);
    for (const auto& after : system_.after) changes += after->apply(local_);
    report_.solve_changes.back() = changes;
    if (changes > 0) stale_ = true;
    if (changes > 0 && options_.working) options_.working(step);
    if (changes > 0 && options_.judge) options_.judge();
    if (options_.max_changes > 0 && step.changes + changes > options_.max_changes) {
      step.changes += changes;
      return fmt::format("more than {} changes in one increment; allow more changes or halvings", options_.max_changes);
    }
    outgrown_ = changes > 0 && options_.outgrown && options_.outgrown();
    if (outgrown_) {
      step.changes += changes;
      break;
    }
  }
  return "";
}

/// What broke in a rejected increment is whole again, so a preconditioner built meanwhile is too soft.
void StaticDriver::restore(Vec saved, Vec u, bool changed)
{
  PDX_CALL(VecCopy(saved, u));
  system_.go_to(reached_);
  if (!changed) return;
  for (const auto& after : system_.after) after->restore();
  stale_ = true;
  rule_.demand();
}

/// Looks for signals too: they end the run in the state accepted last.
std::string StaticDriver::attempted(Step& step, Vec saved, Vec u)
{
  try {
    stop_if_told(system_.rows.comm);
    return equilibrium(step, u);
  } catch (const Stopped&) {
    restore(saved, u, true);
    throw;
  } catch (const UserError&) {
    restore(saved, u, true);
    throw;
  }
}

void StaticDriver::run(Vec u, const Accepted& accepted)
{
  LoadPath all = path();
  run(u, all, accepted);
}

/// The next load, or what is left of one.
Step StaticDriver::begin(Vec u, Vec saved, const LoadPath& path, std::optional<OpenStep>* open)
{
  if (open && *open) {
    field::set_owned_values(saved, (*open)->start);
    return std::exchange(*open, std::nullopt)->step;
  }
  PDX_CALL(VecCopy(u, saved));
  for (const auto& after : system_.after) after->save();
  return {report_.steps + 1, path.target()};
}

Verdict StaticDriver::run(Vec u, LoadPath& path, const Accepted& accepted, std::optional<OpenStep>* open)
{
  const VecHandle saved = system_.rows.vector();
  while (!path.done()) {
    Step step = begin(u, saved.get(), path, open);
    reached_ = path.reached();
    const std::string why = attempted(step, saved.get(), u);
    if (why.empty() && outgrown_) {
      *open = OpenStep{step, field::owned_values(saved.get())};
      return Verdict::relayout;
    }
    if (why.empty()) {
      path.advance();
      report_.steps = step.number;
      report_.passes += step.passes;
      report_.changes += step.changes;
      if (const Verdict verdict = accepted(step, u); verdict != Verdict::go_on) return verdict;
      continue;
    }
    restore(saved.get(), u, step.changes > 0);
    // A linear solver that fails at one load fails at any.
    const bool hopeless = system_.linear() && step.changes == 0;
    const std::string where = fmt::format(
        "load step {} of {} failed at load {:.6g} ({}{} passes, {} changes): ", path.increment(), options_.load_steps,
        step.load, report_.halvings ? fmt::format("increment {:.3g}, ", path.size()) : "", step.passes, step.changes);
    if (hopeless || !path.halve())
      throw SolverFailure(fmt::format("{}{}{}", where, step.changes > 0 ? kUnstable : "", why));
    ++report_.halvings;
    if (options_.working) options_.working(step);
  }
  return Verdict::go_on;
}
} // namespace pdx::solve
