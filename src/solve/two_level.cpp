#include "pdx/solve/two_level.hpp"

#include "pdx/base/events.hpp"
#include "pdx/solve/bordered_factor.hpp"
#include "pdx/solve/rigid_modes.hpp"

namespace pdx::solve {
namespace {
// The smoother works on [kLower, kUpper] of the block-Jacobi scaled spectrum, which no damage takes above 2 in the
// lattice and which reaches 2.2 to 2.3 in square elements; Chebyshev stays definite up to kLower + kUpper.
constexpr double kLower = 0.3, kUpper = 2.3;
constexpr double kBound = 4.0; // what couples n rows has at most n there: elements 4, bonds 2, carried bonds up to 4
constexpr PetscInt kSmoothings = 2;

/// BoomerAMG's relaxation has no call of its own, only options: forward sweeps going down and backward sweeps going up
/// stay symmetric at half the price of symmetric sweeps both ways, for one or two iterations more.
void prefer(const char* name, const char* value)
{
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, name, &given));
  if (given) return;
  PDX_CALL(PetscOptionsSetValue(nullptr, name, value));
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, name, &given)); // counts as used: with another -pc_type nobody asks
}

/// A coarse level that is factored, in the hands of its PC.
using Factor = std::unique_ptr<BorderedFactor>;

Factor* factor_of(PC pc)
{
  void* context = nullptr;
  PDX_CALL(PCShellGetContext(pc, &context));
  return static_cast<Factor*>(context);
}

PetscErrorCode apply_factor(PC pc, Vec x, Vec y)
{
  return guard([&] {
    static Event event("solve_coarse_factor");
    const Timed timed(event);
    (*factor_of(pc))->solve(x, y);
  });
}

PetscErrorCode destroy_factor(PC pc)
{
  return guard([&] { delete factor_of(pc); });
}

void make_factored(PC pc)
{
  PDX_CALL(PCSetType(pc, PCSHELL));
  PDX_CALL(PCShellSetName(pc, "Cholesky, dense at the border"));
  PDX_CALL(PCShellSetContext(pc, new Factor));
  PDX_CALL(PCShellSetApply(pc, apply_factor));
  PDX_CALL(PCShellSetDestroy(pc, destroy_factor));
}

/// Unless the user chose another PC for the coarse level.
void factor_again(KSP coarse, Mat matrix, const field::Rows& rows)
{
  PC pc = nullptr;
  PetscBool ours = PETSC_FALSE;
  PDX_CALL(KSPGetPC(coarse, &pc));
  PDX_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCSHELL, &ours));
  if (ours) *factor_of(pc) = std::make_unique<BorderedFactor>(matrix, rows.dim * rows.nodes);
}

bool all_sweeps_chosen()
{
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-mg_coarse_pc_hypre_boomeramg_relax_type_all", &given));
  return given;
}
} // namespace

TwoLevel::TwoLevel(const field::System& system, const TangentOperator& tangent)
    : system_(system), tangent_(tangent), prolongation_(std::make_unique<Prolongation>(system, *system.coarse))
{}

void TwoLevel::configure(PC pc)
{
  PDX_CALL(PCSetType(pc, PCMG));
  PDX_CALL(PCMGSetLevels(pc, 2, nullptr));
  PDX_CALL(PCMGSetInterpolation(pc, 1, prolongation_->matrix()));
  PDX_CALL(PCMGSetRestriction(pc, 1, prolongation_->restriction()));
  KSP smoother = nullptr, coarse = nullptr;
  PC inner = nullptr;
  PDX_CALL(PCMGGetSmoother(pc, 1, &smoother));
  PDX_CALL(KSPSetType(smoother, KSPCHEBYSHEV));
  PDX_CALL(KSPChebyshevSetEigenvalues(smoother, wide_ ? kBound : kUpper, kLower));
  PDX_CALL(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, kSmoothings));
  PDX_CALL(KSPSetNormType(smoother, KSP_NORM_NONE));
  PDX_CALL(KSPSetOperators(smoother, tangent_.matrix(), tangent_.matrix()));
  PDX_CALL(KSPGetPC(smoother, &inner));
  PDX_CALL(PCSetType(inner, PCPBJACOBI));
  PDX_CALL(PCMGGetCoarseSolve(pc, &coarse));
  PDX_CALL(KSPSetType(coarse, KSPPREONLY));
  PDX_CALL(KSPGetPC(coarse, &inner));
  if (system_.coarse->wants_factor()) return make_factored(inner);
  PDX_CALL(PCSetType(inner, PCHYPRE));
  PDX_CALL(PCHYPRESetType(inner, "boomeramg"));
  if (all_sweeps_chosen()) return;
  prefer("-mg_coarse_pc_hypre_boomeramg_relax_type_down", "SOR/Jacobi");
  prefer("-mg_coarse_pc_hypre_boomeramg_relax_type_up", "backward-SOR/Jacobi");
}

void TwoLevel::update(PC pc, std::span<const double> u)
{
  PetscBool used = PETSC_FALSE;
  PDX_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCMG, &used));
  if (!used) return;
  if (coarse_ && system_.coarse->rebuild()) {
    // Levels keep vectors and matrices of the old size, and PETSc remakes them only with the whole preconditioner.
    PDX_CALL(PCSetType(pc, PCNONE));
    prolongation_ = std::make_unique<Prolongation>(system_, *system_.coarse);
    configure(pc);
    PDX_CALL(PCSetFromOptions(pc));
  }
  coarse_ = system_.coarse->assemble(u);
  const NullSpaceHandle modes = rigid_modes(system_.coarse->halo().rows(), system_.coarse->coordinates());
  PDX_CALL(MatSetNearNullSpace(coarse_.get(), modes.get()));
  PDX_CALL(MatSetOption(coarse_.get(), MAT_SPD, PETSC_TRUE));
  KSP coarse = nullptr;
  PDX_CALL(PCMGGetCoarseSolve(pc, &coarse));
  PDX_CALL(KSPSetOperators(coarse, coarse_.get(), coarse_.get()));
  if (system_.coarse->wants_factor()) factor_again(coarse, coarse_.get(), system_.coarse->halo().rows());
}

bool TwoLevel::widen(PC pc)
{
  PetscBool used = PETSC_FALSE, chosen = PETSC_FALSE, chebyshev = PETSC_FALSE;
  PDX_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCMG, &used));
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-mg_levels_ksp_chebyshev_eigenvalues", &chosen));
  if (!used || chosen || wide_) return false;
  KSP smoother = nullptr;
  PDX_CALL(PCMGGetSmoother(pc, 1, &smoother));
  PDX_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(smoother), KSPCHEBYSHEV, &chebyshev));
  if (!chebyshev) return false;
  PDX_CALL(KSPChebyshevSetEigenvalues(smoother, kBound, kLower));
  return wide_ = true;
}

bool sweep_safely(PC pc)
{
  constexpr const char* kSweeps = "-pc_hypre_boomeramg_relax_type_";
  PetscBool multigrid = PETSC_FALSE, given = PETSC_FALSE;
  PetscMPIInt ranks = 1;
  PDX_CALL(MPI_Comm_size(PetscObjectComm(reinterpret_cast<PetscObject>(pc)), &ranks));
  PDX_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCHYPRE, &multigrid));
  if (ranks == 1 || !multigrid) return false;
  for (const char* which : {"all", "up", "down"}) {
    PDX_CALL(PetscOptionsHasName(nullptr, nullptr, (std::string(kSweeps) + which).c_str(), &given));
    if (given) return false;
  }
  prefer("-pc_hypre_boomeramg_relax_type_all", "l1scaled-SOR/Jacobi");
  PDX_CALL(PCSetFromOptions(pc));
  return true;
}
} // namespace pdx::solve
