#pragma once
#include "pdx/base/petsc.hpp"

#include <petscksp.h>
#include <string_view>

namespace pdx::solve {
/// The PC types that need no assembled matrix.
bool works_matrix_free(std::string_view pc_type);

/// Throws UserError for a Krylov method that cannot solve a system: it would end far from the answer, or in PETSc's own
/// words. @param symmetric is the tangent?
void refuse_wrong_krylov(KSP ksp, bool symmetric);
} // namespace pdx::solve
