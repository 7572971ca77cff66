#pragma once
#include "pdx/field/rows.hpp"

namespace pdx::field {
/// Adds dense panels of dim x dim blocks to a sparse matrix, with prescribed components eliminated symmetrically:
/// their rows and columns stay out, `finish` puts `scale` on their diagonal. Rows of other ranks are left to them,
/// so nothing travels and the sum order is fixed.
class BlockAdder {
public:
  /// @param held one flag per component of every local row (size halo.size() * dim), 1 = prescribed
  BlockAdder(Mat matrix, const RowHalo& halo, std::span<const std::uint8_t> held);
  /// For a matrix of other rows. @param renumbered global row there of every local row, -1: what it would get is
  /// dropped
  BlockAdder(Mat matrix, const RowHalo& halo, std::span<const std::uint8_t> held, std::span<const PetscInt> renumbered);

  /// values: (n rows * dim) x (m columns * dim), row-major [N/m]; local row numbers.
  void add(std::span<const Index> rows, std::span<const Index> columns, std::span<const double> values);
  /// Puts `scale` [N/m] on the diagonal of prescribed components and assembles. Collective.
  void finish(double scale);
  Mat matrix() const { return matrix_; }

private:
  PetscInt place(Index local) const
  {
    return renumbered_.empty() ? halo_.global(local) : renumbered_[static_cast<std::size_t>(local)];
  }

  Mat matrix_;
  const RowHalo& halo_;
  std::span<const std::uint8_t> held_;
  std::span<const PetscInt> renumbered_; // empty: rows are those of the halo
  int dim_;
  std::vector<PetscInt> rows_, columns_;
  std::vector<double> panel_;
};

/// Upper bounds of the blocks each owned row couples with, in the diagonal and off-diagonal part of the matrix.
struct Couplings {
  explicit Couplings(const RowHalo& halo);
  void add(Index row, Index column); ///< local rows; ignored if `row` is not owned
  const RowHalo& halo;
  std::vector<PetscInt> diagonal, off_diagonal;
};
} // namespace pdx::field
