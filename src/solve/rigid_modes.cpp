#include "pdx/solve/rigid_modes.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
/// Rigid motion opens no crack: enriched rows stay at 0.
MatNullSpace without_enriched(const field::Rows& rows, MatNullSpace modes)
{
  PetscInt count = 0;
  const Vec* given = nullptr;
  PDX_CALL(MatNullSpaceGetVecs(modes, nullptr, &count, &given));
  std::vector<Vec> kept(static_cast<std::size_t>(count));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    PDX_CALL(VecDuplicate(given[k], &kept[k]));
    PDX_CALL(VecCopy(given[k], kept[k]));
    double* values = nullptr;
    PDX_CALL(VecGetArray(kept[k], &values));
    std::fill_n(values + rows.dim * rows.nodes, rows.dim * rows.enriched, 0.0);
    PDX_CALL(VecRestoreArray(kept[k], &values));
    for (std::size_t j = 0; j < k; ++j) {
      PetscScalar along = 0.0;
      PDX_CALL(VecDot(kept[k], kept[j], &along));
      PDX_CALL(VecAXPY(kept[k], -along, kept[j]));
    }
    PDX_CALL(VecNormalize(kept[k], nullptr));
  }
  MatNullSpace result = nullptr;
  PDX_CALL(MatNullSpaceCreate(rows.comm, PETSC_FALSE, count, kept.data(), &result));
  for (Vec& mode : kept) PDX_CALL(VecDestroy(&mode));
  return result;
}
} // namespace

NullSpaceHandle rigid_modes(const field::Rows& rows, std::span<const double> coordinates)
{
  const VecHandle x = rows.vector();
  double* values = nullptr;
  PDX_CALL(VecGetArray(x.get(), &values));
  std::copy(coordinates.begin(), coordinates.end(), values);
  PDX_CALL(VecRestoreArray(x.get(), &values));
  NullSpaceHandle modes;
  PDX_CALL(MatNullSpaceCreateRigidBody(x.get(), modes.out()));
  PetscInt enriched = rows.enriched;
  MPI_Allreduce(MPI_IN_PLACE, &enriched, 1, MPIU_INT, MPI_MAX, rows.comm);
  if (enriched == 0) return modes;
  NullSpaceHandle result;
  *result.out() = without_enriched(rows, modes.get());
  return result;
}
} // namespace pdx::solve
