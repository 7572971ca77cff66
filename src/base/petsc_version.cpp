#include "pdx/base/petsc_version.hpp"

namespace pdx {
namespace {
PetscErrorCode product(Mat, Vec, Vec to) { return VecSet(to, 1.0); }
PetscErrorCode product_of_transpose(Mat, Vec, Vec to) { return VecSet(to, 2.0); }

bool try_restriction()
{
  MatHandle probe;
  VecHandle x, y;
  double told = 0.0;
  PDX_CALL(MatCreateShell(PETSC_COMM_SELF, 1, 1, 1, 1, nullptr, probe.out()));
  PDX_CALL(MatShellSetOperation(probe.get(), MATOP_MULT, reinterpret_cast<void (*)()>(product)));
  PDX_CALL(MatShellSetOperation(probe.get(), MATOP_MULT_TRANSPOSE, reinterpret_cast<void (*)()>(product_of_transpose)));
  PDX_CALL(MatCreateVecs(probe.get(), x.out(), y.out()));
  PDX_CALL(VecSet(x.get(), 0.0));
  PDX_CALL(MatRestrict(probe.get(), x.get(), y.get()));
  PDX_CALL(VecMax(y.get(), nullptr, &told));
  return told > 1.5;
}
} // namespace

bool restricts_by_transpose()
{
  static const bool transpose = try_restriction();
  return transpose;
}
} // namespace pdx
