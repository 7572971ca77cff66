#pragma once
#include <string_view>

namespace pdx {
/// Does it begin like an option that some object of PETSc may look for (-ksp_..., -mg_levels_...)?
bool is_petsc_family(std::string_view name);
/// Is it one of PETSc's options, by its family (-ksp_..., -mg_levels_...) or in full (-log_view)?
bool is_petsc_name(std::string_view name);
/// The end of a message about a value that PETSc refused.
constexpr std::string_view kPetscValue = " (the value of a PETSc option)";
} // namespace pdx
