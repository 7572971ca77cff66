#include "pdx/solve/matrix_rows.hpp"

namespace pdx::solve {
MatrixRows::MatrixRows(Mat matrix) : matrix_(matrix)
{
  if (!matrix_) return;
  PetscBool blocks = PETSC_FALSE, done = PETSC_FALSE;
  PDX_CALL(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(matrix_), MATSEQBAIJ, &blocks));
  blocks_ = blocks;
  if (blocks_) {
    copy_blocks();
    return;
  }
  PDX_CALL(MatGetRowIJ(matrix_, 0, PETSC_FALSE, PETSC_FALSE, &rows_, &offsets_, &columns_, &done));
  PDX_CALL(MatSeqAIJGetArrayRead(matrix_, &values_));
  size_ = rows_;
}

/// Blocks stand column by column, each as PETSc has it.
void MatrixRows::copy_blocks()
{
  PetscInt dim = 1;
  PetscBool done = PETSC_FALSE;
  const PetscInt *offsets = nullptr, *columns = nullptr;
  double* values = nullptr;
  PDX_CALL(MatGetBlockSize(matrix_, &dim));
  PDX_CALL(MatGetRowIJ(matrix_, 0, PETSC_FALSE, PETSC_TRUE, &rows_, &offsets, &columns, &done));
  PDX_CALL(MatSeqBAIJGetArray(matrix_, &values));
  size_ = rows_ * dim;
  const auto entries = static_cast<std::size_t>(offsets[rows_] * dim * dim);
  own_columns_.reserve(entries);
  own_values_.reserve(entries);
  own_offsets_.reserve(static_cast<std::size_t>(size_) + 1);
  own_offsets_.push_back(0);
  for (PetscInt row = 0; row < rows_; ++row)
    for (PetscInt a = 0; a < dim; ++a) {
      for (PetscInt k = offsets[row]; k < offsets[row + 1]; ++k)
        for (PetscInt b = 0; b < dim; ++b) {
          own_columns_.push_back(columns[k] * dim + b);
          own_values_.push_back(values[(k * dim + b) * dim + a]);
        }
      own_offsets_.push_back(static_cast<PetscInt>(own_columns_.size()));
    }
  PDX_CALL(MatSeqBAIJRestoreArray(matrix_, &values));
  PDX_CALL(MatRestoreRowIJ(matrix_, 0, PETSC_FALSE, PETSC_TRUE, &rows_, &offsets, &columns, &done));
  offsets_ = own_offsets_.data();
  columns_ = own_columns_.data();
  values_ = own_values_.data();
}

MatrixRows::~MatrixRows()
{
  if (!matrix_ || blocks_) return;
  PetscBool done = PETSC_FALSE;
  (void)MatSeqAIJRestoreArrayRead(matrix_, &values_);
  (void)MatRestoreRowIJ(matrix_, 0, PETSC_FALSE, PETSC_FALSE, &rows_, &offsets_, &columns_, &done);
}
} // namespace pdx::solve
