#pragma once
#include "pdx/base/petsc.hpp"

#include <span>
#include <vector>

namespace pdx::solve {
/// Entries of a sequential MATAIJ or MATBAIJ row by row: those of the one where they are, those of the other copied.
class MatrixRows {
public:
  /// @param matrix must outlive it and stay as it is; null: no rows
  explicit MatrixRows(Mat matrix);
  ~MatrixRows();
  MatrixRows(const MatrixRows&) = delete;
  MatrixRows& operator=(const MatrixRows&) = delete;

  Mat matrix() const { return matrix_; }
  std::size_t size() const { return static_cast<std::size_t>(size_); }
  template <class Visit> void for_each(PetscInt row, Visit&& visit) const
  {
    for (PetscInt k = offsets_[row]; k < offsets_[row + 1]; ++k) visit(columns_[k], values_[k]);
  }

private:
  void copy_blocks();

  Mat matrix_;
  bool blocks_ = false;
  PetscInt size_ = 0, rows_ = 0; // components, and rows that are borrowed
  const PetscInt *offsets_ = nullptr, *columns_ = nullptr;
  const PetscScalar* values_ = nullptr;
  std::vector<PetscInt> own_offsets_, own_columns_;
  std::vector<double> own_values_;
};
} // namespace pdx::solve
