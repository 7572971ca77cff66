#include "pdx/solve/rigid_modes.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// Springs along the lines between all pairs of places: nothing strains them but what is no rigid motion.
MatHandle truss(const std::vector<double>& x, PetscInt dim, PetscInt enriched)
{
  const auto rows = static_cast<PetscInt>(x.size()) / dim;
  MatHandle k;
  PDX_CALL(MatCreateSeqDense(PETSC_COMM_SELF, rows * dim, rows * dim, nullptr, k.out()));
  for (PetscInt i = 0; i < rows - enriched; ++i)
    for (PetscInt j = 0; j < i; ++j)
      for (PetscInt a = 0; a < dim; ++a)
        for (PetscInt b = 0; b < dim; ++b) {
          const auto away = [&](PetscInt d) {
            return x[static_cast<std::size_t>(i * dim + d)] - x[static_cast<std::size_t>(j * dim + d)];
          };
          const double entry = away(a) * away(b);
          for (const auto& [row, column, sign] : {std::tuple{i, i, 1.0}, {i, j, -1.0}, {j, i, -1.0}, {j, j, 1.0}})
            PDX_CALL(MatSetValue(k.get(), row * dim + a, column * dim + b, sign * entry, ADD_VALUES));
        }
  PDX_CALL(MatAssemblyBegin(k.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(k.get(), MAT_FINAL_ASSEMBLY));
  return k;
}

void expect_rigid(PetscInt dim, PetscInt nodes, PetscInt enriched, const std::vector<double>& x)
{
  const field::Rows rows = field::Rows::number(PETSC_COMM_SELF, dim, nodes, enriched, 0);
  const NullSpaceHandle modes = solve::rigid_modes(rows, x);
  const MatHandle k = truss(x, dim, enriched);
  PetscInt count = 0;
  const Vec* found = nullptr;
  PDX_CALL(MatNullSpaceGetVecs(modes.get(), nullptr, &count, &found));
  ASSERT_EQ(count, dim == 2 ? 3 : 6);
  const VecHandle force = rows.vector();
  for (PetscInt m = 0; m < count; ++m) {
    PetscReal norm = 0.0;
    PDX_CALL(MatMult(k.get(), found[m], force.get()));
    PDX_CALL(VecNorm(force.get(), NORM_2, &norm));
    EXPECT_LT(norm, 1e-12);
    const double* values = nullptr;
    PDX_CALL(VecGetArrayRead(found[m], &values));
    for (PetscInt e = dim * nodes; e < dim * (nodes + enriched); ++e) EXPECT_EQ(values[e], 0.0);
    PDX_CALL(VecRestoreArrayRead(found[m], &values));
    for (PetscInt n = 0; n <= m; ++n) {
      PetscScalar along = 0.0;
      PDX_CALL(VecDot(found[m], found[n], &along));
      EXPECT_NEAR(along, m == n ? 1.0 : 0.0, 1e-12);
    }
  }
}
} // namespace

TEST(RigidModes, StrainNothingInThePlane) { expect_rigid(2, 4, 0, {0.1, 0.2, 1.3, 0.1, 0.4, 0.9, 2.0, 1.7}); }

TEST(RigidModes, OpenNoCrack) { expect_rigid(2, 4, 2, {0.1, 0.2, 1.3, 0.1, 0.4, 0.9, 2.0, 1.7, 0.1, 0.2, 1.3, 0.1}); }

TEST(RigidModes, StrainNothingInSpace)
{
  expect_rigid(3, 5, 0, {0.0, 0.1, 0.2, 1.3, 0.1, 0.7, 0.4, 0.9, 0.3, 2.0, 1.7, 1.1, 0.5, 0.5, 2.5});
}
