#include "pdx/base/block_type.hpp"

#include "pdx/base/petsc.hpp"

#include <map>

namespace pdx {
namespace {
std::map<int, MPI_Datatype>& types()
{
  static std::map<int, MPI_Datatype> by_components;
  return by_components;
}

PetscErrorCode free_types()
{
  for (auto& [components, type] : types()) MPI_Type_free(&type);
  types().clear();
  return 0;
}
} // namespace

MPI_Datatype block_type(int components)
{
  if (components == 1) return MPI_DOUBLE; // PETSc adds numbers and longer blocks, not blocks of one
  if (types().empty()) PDX_CALL(PetscRegisterFinalize(free_types));
  const auto [at, made] = types().try_emplace(components, MPI_DATATYPE_NULL);
  if (made) {
    MPI_Type_contiguous(components, MPI_DOUBLE, &at->second);
    MPI_Type_commit(&at->second);
  }
  return at->second;
}
} // namespace pdx
