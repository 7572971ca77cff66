#include "pdx/solve/rigid_modes.hpp"

#include <algorithm>

namespace pdx::solve {
NullSpaceHandle rigid_modes(const field::Rows& rows, std::span<const double> coordinates)
{
  const VecHandle x = rows.vector();
  double* values = nullptr;
  PDX_CALL(VecGetArray(x.get(), &values));
  std::copy(coordinates.begin(), coordinates.end(), values);
  PDX_CALL(VecRestoreArray(x.get(), &values));
  NullSpaceHandle modes;
  PDX_CALL(MatNullSpaceCreateRigidBody(x.get(), modes.out()));
  return modes;
}
} // namespace pdx::solve
