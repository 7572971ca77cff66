#include "pdx/solve/bordered_factor.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// `dense` components that are coupled each with each, and a chain of others that hangs on them by both ends.
MatHandle bordered(PetscInt dense, PetscInt chain)
{
  const PetscInt size = dense + chain;
  MatHandle k;
  PDX_CALL(MatCreateSeqAIJ(PETSC_COMM_SELF, size, size, size, nullptr, k.out()));
  const auto add = [&](PetscInt row, PetscInt column, double value) {
    PDX_CALL(MatSetValue(k.get(), row, column, value, ADD_VALUES));
  };
  for (PetscInt a = 0; a < dense; ++a)
    for (PetscInt b = 0; b < dense; ++b) add(a, b, a == b ? dense + 3.0 : 1.0 / (1.0 + a + b));
  for (PetscInt a = dense; a < size; ++a) add(a, a, 2.0);
  for (PetscInt a = dense - 1; a < size; ++a) {
    const PetscInt next = a + 1 < size ? a + 1 : 0;
    if (chain == 0) break;
    add(a, next, -1.0);
    add(next, a, -1.0);
  }
  PDX_CALL(MatAssemblyBegin(k.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(k.get(), MAT_FINAL_ASSEMBLY));
  return k;
}

/// Largest error of a solve whose answer is 1, 2, 3, ...
double error(PetscInt dense, PetscInt chain)
{
  const MatHandle k = bordered(dense, chain);
  VecHandle known, force, found;
  PDX_CALL(MatCreateVecs(k.get(), known.out(), force.out()));
  PDX_CALL(VecDuplicate(known.get(), found.out()));
  for (PetscInt a = 0; a < dense + chain; ++a) PDX_CALL(VecSetValue(known.get(), a, a + 1.0, INSERT_VALUES));
  PDX_CALL(MatMult(k.get(), known.get(), force.get()));
  solve::BorderedFactor(k.get(), dense).solve(force.get(), found.get());
  double worst = 0.0;
  PDX_CALL(VecAXPY(found.get(), -1.0, known.get()));
  PDX_CALL(VecNorm(found.get(), NORM_INFINITY, &worst));
  return worst;
}
} // namespace

TEST(BorderedFactor, SolvesWithAndWithoutEitherPart)
{
  EXPECT_LT(error(5, 40), 1e-10);
  EXPECT_LT(error(5, 0), 1e-10);
  EXPECT_LT(error(1, 30), 1e-10);
  EXPECT_LT(error(1250, 3), 1e-9); // too large for an inverse
}
