#include "pdx/solve/two_level.hpp"

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

/// Cholesky, on more ranks by each for itself.
void factor(PC pc, MPI_Comm comm)
{
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  PC alone = pc;
  if (ranks > 1) {
    KSP inner = nullptr;
    PDX_CALL(PCSetType(pc, PCREDUNDANT));
    PDX_CALL(PCRedundantGetKSP(pc, &inner));
    PDX_CALL(KSPGetPC(inner, &alone));
  }
  PDX_CALL(PCSetType(alone, PCCHOLESKY));
  PetscBool known = PETSC_FALSE, supernodal = PETSC_FALSE;
  PDX_CALL(MatSolverTypeGet(MATSOLVERCHOLMOD, MATSEQAIJ, MAT_FACTOR_CHOLESKY, &known, &supernodal, nullptr));
  if (supernodal) PDX_CALL(PCFactorSetMatSolverType(alone, MATSOLVERCHOLMOD));
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
  if (system_.coarse->wants_factor()) return factor(inner, system_.rows.comm);
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
} // namespace pdx::solve
