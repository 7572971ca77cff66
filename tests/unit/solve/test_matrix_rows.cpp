#include "pdx/solve/matrix_rows.hpp"

#include <gtest/gtest.h>
#include <map>
#include <random>

using namespace pdx;

namespace {
/// Blocks of two, some of them there.
MatHandle some_blocks(MatType type)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  MatHandle matrix;
  PDX_CALL(MatCreate(PETSC_COMM_SELF, matrix.out()));
  PDX_CALL(MatSetSizes(matrix.get(), 10, 10, 10, 10));
  PDX_CALL(MatSetBlockSize(matrix.get(), 2));
  PDX_CALL(MatSetType(matrix.get(), type));
  PDX_CALL(MatSetUp(matrix.get()));
  for (PetscInt row = 0; row < 5; ++row)
    for (PetscInt column = 0; column < 5; ++column) {
      double block[4];
      for (double& entry : block) entry = value(random);
      if ((row + 2 * column) % 3 && row != column) continue;
      PDX_CALL(MatSetValuesBlocked(matrix.get(), 1, &row, 1, &column, block, INSERT_VALUES));
    }
  PDX_CALL(MatAssemblyBegin(matrix.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(matrix.get(), MAT_FINAL_ASSEMBLY));
  return matrix;
}
} // namespace

TEST(MatrixRows, AreThoseThatPetscGivesOneByOne)
{
  for (const MatType type : {MATSEQAIJ, MATSEQBAIJ}) {
    const MatHandle matrix = some_blocks(type);
    std::map<std::pair<PetscInt, PetscInt>, double> seen;
    {
      const solve::MatrixRows rows(matrix.get());
      ASSERT_EQ(rows.size(), 10u);
      for (PetscInt row = 0; row < 10; ++row)
        rows.for_each(row, [&](PetscInt column, double entry) {
          EXPECT_TRUE(seen.try_emplace(std::pair{row, column}, entry).second) << "twice";
        });
    }
    for (PetscInt row = 0; row < 10; ++row)
      for (PetscInt column = 0; column < 10; ++column) {
        double entry = 0.0;
        PDX_CALL(MatGetValues(matrix.get(), 1, &row, 1, &column, &entry));
        const auto at = seen.find({row, column});
        EXPECT_EQ(at == seen.end() ? 0.0 : at->second, entry) << type << ' ' << row << ' ' << column;
      }
  }
}

TEST(MatrixRows, AreNoneOfNoMatrix) { EXPECT_EQ(solve::MatrixRows(nullptr).size(), 0u); }
