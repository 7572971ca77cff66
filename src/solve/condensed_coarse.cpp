#include "pdx/solve/condensed_coarse.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <numeric>

namespace pdx::solve {
CondensedCoarse::CondensedCoarse(const KeptRows& kept, const Condensation& condensation)
    : kept_(kept), condensation_(condensation)
{
  lay_out();
  change_basis();
}

bool CondensedCoarse::rebuild()
{
  if (!whole().rebuild()) return false;
  lay_out();
  return true;
}

/// Kept nodes and sets are the first of a rank's rows here as among the fine ones.
void CondensedCoarse::lay_out()
{
  const field::RowHalo& all = whole().halo();
  const Index kept = kept_.rows().first_particle(), nodes = whole().node_rows();
  owned_.clear();
  for (Index row = 0; row < kept; ++row) owned_.push_back(kept_.whole_row(row));
  for (Index row = nodes; row < all.rows().owned(); ++row) owned_.push_back(row);
  const field::Rows rows =
      field::Rows::number(kept_.rows().comm, kept_.rows().dim, kept, 0, static_cast<Index>(owned_.size()) - kept);
  std::vector<double> numbers(static_cast<std::size_t>(all.rows().owned()), -1.0), everywhere;
  for (std::size_t k = 0; k < owned_.size(); ++k)
    numbers[static_cast<std::size_t>(owned_[k])] = static_cast<double>(rows.first) + static_cast<double>(k);
  all.fetch(numbers, 1, everywhere);
  std::vector<PetscInt> needed;
  for (std::size_t k = static_cast<std::size_t>(all.rows().owned()); k < everywhere.size(); ++k)
    if (everywhere[k] >= 0.0) needed.push_back(static_cast<PetscInt>(everywhere[k]));
  halo_ = std::make_unique<field::RowHalo>(rows, needed);
  std::vector<Index> column;
  for (const double number : everywhere)
    column.push_back(number < 0.0 ? -1 : halo_->local(static_cast<PetscInt>(number)));
  interpolate(column);
  std::vector<PetscInt> mine(static_cast<std::size_t>(kept * rows.dim));
  std::iota(mine.begin(), mine.end(), rows.first * rows.dim);
  columns_ = gather_all(rows.comm, mine);
}

/// @param column local row here of every local coarse row of the whole System, -1 if it was eliminated
void CondensedCoarse::interpolate(std::span<const Index> column)
{
  const field::Interpolation& from = whole().interpolation();
  interpolation_ = {};
  interpolation_.offsets.push_back(0);
  for (Index row = 0; row < kept_.rows().owned(); ++row) {
    const auto fine = static_cast<std::size_t>(kept_.whole_row(row));
    for (std::size_t k = from.offsets[fine]; k < from.offsets[fine + 1]; ++k) {
      const Index to = column[static_cast<std::size_t>(from.columns[k])];
      if (to < 0) continue; // a crack that came since: near enough for a coarse level
      interpolation_.columns.push_back(to);
      interpolation_.weights.push_back(from.weights[k]);
    }
    interpolation_.offsets.push_back(interpolation_.columns.size());
  }
}

/// S -> T^T S T with the interpolation T of kept nodes and sets, prescribed components left out.
void CondensedCoarse::change_basis()
{
  struct Share {
    Index fine, coarse; // of all kept rows
    double weight;
  };
  const auto dim = static_cast<Eigen::Index>(kept_.rows().dim);
  const Index first = condensation_.first() / kept_.rows().dim;
  std::vector<Share> mine;
  std::vector<std::uint8_t> held;
  for (Index row = 0; row < kept_.rows().first_particle(); ++row) {
    const auto at = static_cast<std::size_t>(row);
    for (std::size_t k = interpolation_.offsets[at]; k < interpolation_.offsets[at + 1]; ++k)
      mine.push_back({first + row, first + interpolation_.columns[k], interpolation_.weights[k]});
    for (Index a = 0; a < kept_.rows().dim; ++a)
      held.push_back(kept_.whole().held[static_cast<std::size_t>(kept_.whole_row(row) * kept_.rows().dim + a)]);
  }
  const std::vector<std::uint8_t> all_held = gather_all(kept_.rows().comm, held);
  const Condensation::Matrix& s = condensation_.stiffness();
  const std::vector<Share> shares = gather_all(kept_.rows().comm, mine);
  stiffness_ = Condensation::Matrix::Zero(s.rows(), s.cols());
  if (s.rows() == 0) return; // this rank keeps none
  Condensation::Matrix right = Condensation::Matrix::Zero(s.rows(), s.cols());
  for (const Share& share : shares)
    right.middleCols(dim * share.coarse, dim) += share.weight * s.middleCols(dim * share.fine, dim);
  for (const Share& share : mine)
    stiffness_.middleRows(dim * (share.coarse - first), dim) +=
        share.weight * right.middleRows(dim * (share.fine - first), dim);
  for (std::size_t c = 0; c < all_held.size(); ++c)
    if (all_held[c]) stiffness_.col(static_cast<Eigen::Index>(c)).setZero();
  for (std::size_t c = 0; c < held.size(); ++c)
    if (held[c]) stiffness_.row(static_cast<Eigen::Index>(c)).setZero();
}

MatHandle CondensedCoarse::assemble(std::span<const double> u)
{
  static Event event("solve_condensed_coarse");
  const Timed timed(event);
  const MatHandle rest = whole().assemble_rest(kept_.widened(u));
  const field::Rows& rows = halo_->rows();
  const PetscInt dim = rows.dim, local = dim * rows.owned(), begin = dim * rows.first;
  std::vector<PetscInt> components;
  for (const Index row : owned_)
    for (PetscInt a = 0; a < dim; ++a) components.push_back(dim * (whole().halo().rows().first + row) + a);
  IS chosen = nullptr;
  MatHandle sparse, matrix;
  PDX_CALL(ISCreateGeneral(rows.comm, local, components.data(), PETSC_USE_POINTER, &chosen));
  PDX_CALL(MatCreateSubMatrix(rest.get(), chosen, chosen, MAT_INITIAL_MATRIX, sparse.out()));
  PDX_CALL(ISDestroy(&chosen));
  const auto kept = static_cast<PetscInt>(stiffness_.rows()), others = static_cast<PetscInt>(stiffness_.cols()) - kept;
  std::vector<PetscInt> diagonal, off_diagonal;
  for (PetscInt row = 0; row < local; ++row) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    PDX_CALL(MatGetRow(sparse.get(), begin + row, &count, &columns, nullptr));
    const auto inside = static_cast<PetscInt>(
        std::count_if(columns, columns + count, [&](PetscInt c) { return c >= begin && c < begin + local; }));
    const PetscInt outside = count - inside; // PETSc takes the count back
    PDX_CALL(MatRestoreRow(sparse.get(), begin + row, &count, &columns, nullptr));
    diagonal.push_back(std::min(local, inside + (row < kept ? kept : 0)));
    off_diagonal.push_back(std::min(dim * rows.total - local, outside + (row < kept ? others : 0)));
  }
  PDX_CALL(MatCreateAIJ(rows.comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, 0, diagonal.data(), 0,
                        off_diagonal.data(), matrix.out()));
  PDX_CALL(MatSetBlockSize(matrix.get(), dim));
  for (PetscInt row = begin; row < begin + local; ++row) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    if (row < begin + kept)
      PDX_CALL(MatSetValues(matrix.get(), 1, &row, kept + others, columns_.data(),
                            stiffness_.data() + static_cast<Eigen::Index>(row - begin) * stiffness_.cols(),
                            ADD_VALUES));
    PDX_CALL(MatGetRow(sparse.get(), row, &count, &columns, &values));
    PDX_CALL(MatSetValues(matrix.get(), 1, &row, count, columns, values, ADD_VALUES));
    PDX_CALL(MatRestoreRow(sparse.get(), row, &count, &columns, &values));
  }
  PDX_CALL(MatAssemblyBegin(matrix.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(matrix.get(), MAT_FINAL_ASSEMBLY));
  return matrix;
}

std::vector<double> CondensedCoarse::coordinates() const
{
  const std::vector<double> all = whole().coordinates();
  const auto dim = static_cast<std::size_t>(kept_.rows().dim);
  std::vector<double> x;
  for (const Index row : owned_)
    for (std::size_t a = 0; a < dim; ++a) x.push_back(all[static_cast<std::size_t>(row) * dim + a]);
  return x;
}
} // namespace pdx::solve
