#include "pdx/field/block_adder.hpp"

namespace pdx::field {
BlockAdder::BlockAdder(Mat matrix, const RowHalo& halo, std::span<const std::uint8_t> held)
    : BlockAdder(matrix, halo, held, {})
{}

BlockAdder::BlockAdder(Mat matrix, const RowHalo& halo, std::span<const std::uint8_t> held,
                       std::span<const PetscInt> renumbered)
    : matrix_(matrix), halo_(halo), held_(held), renumbered_(renumbered), dim_(halo.rows().dim)
{}

void BlockAdder::add(std::span<const Index> rows, std::span<const Index> columns, std::span<const double> values)
{
  const auto d = static_cast<std::size_t>(dim_);
  const std::size_t width = columns.size() * d;
  rows_.resize(rows.size());
  columns_.resize(columns.size());
  bool mine = false, masked = false;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const bool own = rows[k] < halo_.rows().owned();
    rows_[k] = own ? place(rows[k]) : -1;
    mine |= own;
    for (std::size_t a = 0; a < d; ++a) masked |= held_[static_cast<std::size_t>(rows[k]) * d + a] != 0;
  }
  if (!mine) return;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    columns_[k] = place(columns[k]);
    for (std::size_t a = 0; a < d; ++a) masked |= held_[static_cast<std::size_t>(columns[k]) * d + a] != 0;
  }
  const double* panel = values.data();
  if (masked) {
    panel_.assign(values.begin(), values.end());
    for (std::size_t r = 0; r < rows.size() * d; ++r)
      for (std::size_t c = 0; c < width; ++c)
        if (held_[static_cast<std::size_t>(rows[r / d]) * d + r % d] ||
            held_[static_cast<std::size_t>(columns[c / d]) * d + c % d])
          panel_[r * width + c] = 0.0;
    panel = panel_.data();
  }
  PDX_CALL(MatSetValuesBlocked(matrix_, static_cast<PetscInt>(rows_.size()), rows_.data(),
                               static_cast<PetscInt>(columns_.size()), columns_.data(), panel, ADD_VALUES));
}

void BlockAdder::finish(double scale)
{
  std::vector<double> block(static_cast<std::size_t>(dim_ * dim_));
  for (Index row = 0; row < halo_.rows().owned(); ++row) {
    bool any = false;
    for (int a = 0; a < dim_; ++a) {
      const bool held = held_[static_cast<std::size_t>(row * dim_ + a)] != 0;
      block[static_cast<std::size_t>(a * dim_ + a)] = held ? scale : 0.0;
      any |= held;
    }
    if (!any) continue;
    const PetscInt global = place(row);
    PDX_CALL(MatSetValuesBlocked(matrix_, 1, &global, 1, &global, block.data(), ADD_VALUES));
  }
  PDX_CALL(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
}

Couplings::Couplings(const RowHalo& h)
    : halo(h), diagonal(static_cast<std::size_t>(h.rows().owned()), 1),
      off_diagonal(static_cast<std::size_t>(h.rows().owned()), 0)
{}

void Couplings::add(Index row, Index column)
{
  const Index owned = halo.rows().owned();
  if (row >= owned || row == column) return;
  ++(column < owned ? diagonal : off_diagonal)[static_cast<std::size_t>(row)];
}
} // namespace pdx::field
