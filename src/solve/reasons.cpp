#include "pdx/solve/reasons.hpp"

#include <fmt/format.h>

namespace pdx::solve {
namespace {
std::string linear_reason(KSP ksp)
{
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  PetscReal norm = 0.0;
  const char* name = nullptr;
  PDX_CALL(KSPGetConvergedReason(ksp, &reason));
  PDX_CALL(KSPGetIterationNumber(ksp, &iterations));
  PDX_CALL(KSPGetResidualNorm(ksp, &norm));
  PDX_CALL(KSPGetConvergedReasonString(ksp, &name));
  const std::string where = fmt::format("after {} iterations at residual {:.2e} N", iterations, norm);
  switch (reason) {
  case KSP_DIVERGED_ITS:
    return fmt::format(
        "the linear solver did not reach its tolerance {}; allow more with -ksp_max_it, or choose another "
        "preconditioner (-pd_operator assembled -pc_type hypre)",
        where);
  case KSP_DIVERGED_INDEFINITE_PC:
  case KSP_DIVERGED_INDEFINITE_MAT:
    return fmt::format("the tangent or its preconditioner is not positive definite {}; the structure may have lost "
                       "stability or support: use smaller steps (-load_steps), or -ksp_type gmres to look further",
                       where);
  case KSP_DIVERGED_NANORINF:
    return fmt::format("the linear solver met a number that is not finite {}; check material, units and loads", where);
  case KSP_DIVERGED_PC_FAILED:
    return "the preconditioner could not be set up; try -pd_operator assembled -pc_type hypre, or -pc_type lu on one "
           "rank";
  default:
    return fmt::format("the linear solver stopped {} ({}); try -ksp_type gmres, or -pd_operator assembled", where,
                       name);
  }
}
} // namespace

std::string reason_of_failure(SNES snes)
{
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  const char* name = nullptr;
  KSP ksp = nullptr;
  PDX_CALL(SNESGetConvergedReason(snes, &reason));
  PDX_CALL(SNESGetIterationNumber(snes, &iterations));
  PDX_CALL(SNESGetConvergedReasonString(snes, &name));
  PDX_CALL(SNESGetKSP(snes, &ksp));
  KSPConvergedReason linear = KSP_CONVERGED_ITERATING;
  PDX_CALL(KSPGetConvergedReason(ksp, &linear));
  if (reason >= 0 && (linear >= 0 || iterations == 0))
    return ""; // without an iteration the linear reason is an old one
  if (reason == SNES_DIVERGED_LINEAR_SOLVE || linear < 0) return linear_reason(ksp);
  switch (reason) {
  case SNES_DIVERGED_LINE_SEARCH:
    return fmt::format("Newton's line search found no decrease at iteration {}; use smaller load steps (-load_steps)",
                       iterations);
  case SNES_DIVERGED_MAX_IT:
    return fmt::format("Newton did not converge in {} iterations; use smaller load steps (-load_steps), or allow more "
                       "with -snes_max_it",
                       iterations);
  case SNES_DIVERGED_FNORM_NAN:
    return fmt::format("the residual is not a number at Newton iteration {}; use smaller load steps (-load_steps)",
                       iterations);
  default:
    return fmt::format("Newton stopped at iteration {} ({}); use smaller load steps (-load_steps)", iterations, name);
  }
}
} // namespace pdx::solve
