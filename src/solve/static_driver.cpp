#include "pdx/solve/static_driver.hpp"

#include "pdx/base/events.hpp"
#include "pdx/solve/reasons.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::solve {
namespace {
constexpr double kRelativeTolerance = 1e-10; // of the true residual norm
constexpr PetscInt kMostIterations = 2000;
constexpr PetscInt kGmresRestart = 60;
} // namespace

bool works_matrix_free(std::string_view pc_type)
{
  return pc_type == PCMG || pc_type == PCNONE || pc_type == PCJACOBI || pc_type == PCPBJACOBI || pc_type == PCKSP;
}

StaticDriver::StaticDriver(const field::System& system, const StaticOptions& options)
    : system_(system), options_(options), tangent_(system, options.assembled || !system.coarse)
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
    PDX_CALL(SNESSetLagPreconditioner(snes, -2));
    PDX_CALL(SNESSetLagPreconditionerPersists(snes, PETSC_TRUE));
  }
  KSP ksp = nullptr;
  PC pc = nullptr;
  PDX_CALL(SNESGetKSP(snes, &ksp));
  PDX_CALL(KSPSetType(ksp, system_.symmetric() ? KSPCG : KSPGMRES));
  if (!system_.symmetric()) {
    PDX_CALL(KSPGMRESSetRestart(ksp, kGmresRestart));
    PDX_CALL(KSPSetPCSide(ksp, PC_RIGHT));
  }
  PDX_CALL(KSPSetTolerances(ksp, kRelativeTolerance, PETSC_DEFAULT, PETSC_DEFAULT, kMostIterations));
  PDX_CALL(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
  PDX_CALL(KSPGetPC(ksp, &pc));
  if (two_level_)
    two_level_->configure(pc);
  else
    PDX_CALL(PCSetType(pc, PCHYPRE));
  PDX_CALL(SNESSetFromOptions(snes));
  refuse_wrong_krylov(ksp, pc);
}

/// A Krylov method that cannot solve this system would end far from the answer, or in PETSc's own words.
void StaticDriver::refuse_wrong_krylov(KSP ksp, PC pc) const
{
  KSPType krylov = nullptr;
  PCType type = nullptr;
  PDX_CALL(KSPGetType(ksp, &krylov));
  PDX_CALL(PCGetType(pc, &type));
  const std::string_view method = krylov, preconditioner = type;
  const bool direct = preconditioner == PCLU || preconditioner == PCCHOLESKY || preconditioner == PCREDUNDANT;
  if (method == KSPPREONLY && !direct)
    throw UserError(
        fmt::format("-ksp_type preonly applies the preconditioner {} once and stops: use it with -pc_type lu "
                    "or cholesky only",
                    preconditioner));
  const bool symmetric_only = method == KSPCG || method == KSPMINRES || method == KSPSYMMLQ || method == KSPCR;
  if (symmetric_only && !system_.symmetric())
    throw UserError(fmt::format("-ksp_type {} needs a symmetric tangent, which -couple_scheme interface has not: use "
                                "gmres or bcgs",
                                method));
}

void StaticDriver::prescribe(Vec u, double load) const
{
  double* values = nullptr;
  PDX_CALL(VecGetArray(u, &values));
  const auto& [components, targets] = system_.prescribed;
  for (std::size_t k = 0; k < components.size(); ++k) values[components[k]] = load * targets[k];
  PDX_CALL(VecRestoreArray(u, &values));
}

std::vector<double> StaticDriver::unbalanced_force(Vec u, double load) const
{
  const double* owned = nullptr;
  PDX_CALL(VecGetArrayRead(u, &owned));
  std::vector<double> r = unbalanced_force({owned, system_.load.size()}, load);
  PDX_CALL(VecRestoreArrayRead(u, &owned));
  return r;
}

std::vector<double> StaticDriver::unbalanced_force(std::span<const double> owned, double load) const
{
  system_.halo->fetch(owned, system_.rows.dim, local_);
  std::vector<double> r(system_.load.size());
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = -load * system_.load[k];
  for (const auto& term : system_.terms) term->add_residual(local_, r);
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
    const std::vector<double> force = self->unbalanced_force(state, self->load_);
    PDX_CALL(VecGetArrayWrite(r, &to));
    std::copy(force.begin(), force.end(), to);
    for (std::size_t k = 0; k < components.size(); ++k)
      to[components[k]] = self->system_.scale * (at[components[k]] - self->load_ * targets[k]);
    PDX_CALL(VecRestoreArrayRead(u, &at));
    PDX_CALL(VecRestoreArrayWrite(r, &to));
  });
}

PetscErrorCode StaticDriver::jacobian(SNES snes, Vec u, Mat operator_matrix, Mat, void* context)
{
  return guard([&] {
    auto* self = static_cast<StaticDriver*>(context);
    self->system_.halo->gather(u, self->local_);
    self->tangent_.update(self->local_);
    if (self->two_level_) {
      KSP ksp = nullptr;
      PC pc = nullptr;
      PDX_CALL(SNESGetKSP(snes, &ksp));
      PDX_CALL(KSPGetPC(ksp, &pc));
      self->two_level_->update(pc, self->local_);
    }
    if (operator_matrix != self->tangent_.matrix()) { // -snes_mf_operator
      PDX_CALL(MatAssemblyBegin(operator_matrix, MAT_FINAL_ASSEMBLY));
      PDX_CALL(MatAssemblyEnd(operator_matrix, MAT_FINAL_ASSEMBLY));
    }
  });
}

PetscErrorCode StaticDriver::record(SNES, PetscInt, PetscReal norm, void* context)
{
  return guard([&] { static_cast<StaticDriver*>(context)->report_.norms.back().push_back(norm); });
}

void StaticDriver::attempt(Vec u)
{
  PetscInt newton = 0, linear = 0;
  const double begin = MPI_Wtime();
  report_.norms.emplace_back();
  prescribe(u, load_);
  PDX_CALL(SNESSolve(snes_.get(), nullptr, u));
  report_.seconds += MPI_Wtime() - begin;
  PDX_CALL(SNESGetIterationNumber(snes_.get(), &newton));
  PDX_CALL(SNESGetLinearSolveIterations(snes_.get(), &linear));
  report_.newton_iterations += newton;
  report_.linear_iterations += linear;
  report_.jacobian_assemblies = tangent_.assemblies();
  report_.preconditioner_builds = two_level_ ? two_level_->builds() : tangent_.assemblies();
}

/// If the linear solver fails, the smoother's fast interval may be too short for this scene: once, with the safe one.
void StaticDriver::solve(int step, Vec u)
{
  static Event event("solve_load");
  Timed timed(event);
  const VecHandle start = system_.rows.vector();
  PDX_CALL(VecCopy(u, start.get()));
  attempt(u);
  std::string why = reason_of_failure(snes_.get());
  KSP ksp = nullptr;
  PC pc = nullptr;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PDX_CALL(SNESGetKSP(snes_.get(), &ksp));
  PDX_CALL(KSPGetPC(ksp, &pc));
  PDX_CALL(KSPGetConvergedReason(ksp, &reason));
  if (!why.empty() && reason < 0 && two_level_ && two_level_->widen(pc)) {
    PDX_CALL(VecCopy(start.get(), u));
    attempt(u);
    why = reason_of_failure(snes_.get());
  }
  if (!why.empty()) throw SolverFailure(fmt::format("load step {} of {} failed: {}", step, options_.load_steps, why));
}

void StaticDriver::run(Vec u, const Accepted& accepted)
{
  for (int step = 1; step <= options_.load_steps; ++step) {
    load_ = static_cast<double>(step) / options_.load_steps;
    solve(step, u);
    report_.steps = step;
    accepted(step, u);
  }
}
} // namespace pdx::solve
