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

  /// values: (n rows * dim) x (m columns * dim), row-major [N/m]; local row numbers.
  void add(std::span<const Index> rows, std::span<const Index> columns, std::span<const double> values);
  /// Puts `scale` [N/m] on the diagonal of prescribed components and assembles. Collective.
  void finish(double scale);

private:
  Mat matrix_;
  const RowHalo& halo_;
  std::span<const std::uint8_t> held_;
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
