#include "pdx/solve/krylov_rules.hpp"

#include <fmt/format.h>

namespace pdx::solve {
bool works_matrix_free(std::string_view pc_type)
{
  return pc_type == PCMG || pc_type == PCNONE || pc_type == PCJACOBI || pc_type == PCPBJACOBI || pc_type == PCKSP;
}

void refuse_wrong_krylov(KSP ksp, bool symmetric)
{
  KSPType krylov = nullptr;
  PCType type = nullptr;
  PDX_CALL(KSPGetType(ksp, &krylov));
  PC pc = nullptr;
  PDX_CALL(KSPGetPC(ksp, &pc));
  PDX_CALL(PCGetType(pc, &type));
  const std::string_view method = krylov, preconditioner = type;
  const bool direct = preconditioner == PCLU || preconditioner == PCCHOLESKY || preconditioner == PCREDUNDANT;
  if (method == KSPPREONLY && !direct)
    throw UserError(
        fmt::format("-ksp_type preonly applies the preconditioner {} once and stops: use it with -pc_type lu "
                    "or cholesky only",
                    preconditioner));
  const bool symmetric_only = method == KSPCG || method == KSPMINRES || method == KSPSYMMLQ || method == KSPCR;
  if (symmetric_only && !symmetric)
    throw UserError(fmt::format("-ksp_type {} needs a symmetric tangent, which -couple_scheme interface has not: use "
                                "gmres or bcgs",
                                method));
}
} // namespace pdx::solve
