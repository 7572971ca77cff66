#include "pdx/solve/tangent_operator.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/symmetric.hpp"
#include "pdx/solve/rigid_modes.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
constexpr double kNoStiffness = 1e-9; // of the scene's scale
} // namespace

TangentOperator::TangentOperator(const field::System& system, bool assembled) : system_(system), assembled_(assembled)
{
  held_components_ = system.prescribed.components;
  make_sparse();
  if (!assembled_) make_shell();
}

void TangentOperator::make_sparse()
{
  const field::Rows& rows = system_.rows;
  field::Couplings couplings(*system_.halo);
  for (const auto& term : system_.terms) term->couplings(couplings, assembled_);
  // Bounds of several Terms add up: on a small scene they may pass what a row can hold, which PETSc refuses.
  for (PetscInt& blocks : couplings.diagonal) blocks = std::min(blocks, rows.owned());
  for (PetscInt& blocks : couplings.off_diagonal) blocks = std::min(blocks, rows.total - rows.owned());
  PDX_CALL(MatCreate(rows.comm, sparse_.out()));
  PDX_CALL(
      MatSetSizes(sparse_.get(), rows.dim * rows.owned(), rows.dim * rows.owned(), PETSC_DETERMINE, PETSC_DETERMINE));
  PDX_CALL(MatSetBlockSize(sparse_.get(), rows.dim));
  // Blocks multiply faster; preconditioners (GAMG, factorisations) want plain rows.
  PDX_CALL(MatSetType(sparse_.get(), assembled_ ? MATAIJ : MATBAIJ));
  PDX_CALL(MatXAIJSetPreallocation(sparse_.get(), rows.dim, couplings.diagonal.data(), couplings.off_diagonal.data(),
                                   nullptr, nullptr));
  PDX_CALL(MatSetOption(sparse_.get(), MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  if (!assembled_) return;
  // A matrix made while a load is tried, for a layout that changed, has no places for bonds that are whole again where
  // the load is given up.
  PDX_CALL(MatSetOption(sparse_.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  const NullSpaceHandle modes = rigid_modes(rows, system_.coordinates);
  PDX_CALL(MatSetNearNullSpace(sparse_.get(), modes.get()));
  if (system_.symmetric()) {
    PDX_CALL(MatSetOption(sparse_.get(), MAT_SYMMETRIC, PETSC_TRUE));
    PDX_CALL(MatSetOption(sparse_.get(), MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
    if (system_.linear()) PDX_CALL(MatSetOption(sparse_.get(), MAT_SPD, PETSC_TRUE));
  }
}

void TangentOperator::make_shell()
{
  const field::Rows& rows = system_.rows;
  const PetscInt local = rows.dim * rows.owned();
  PDX_CALL(MatCreateShell(rows.comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, this, shell_.out()));
  PDX_CALL(MatSetBlockSize(shell_.get(), rows.dim));
  const auto set = [&](MatOperation operation, auto function) {
    PDX_CALL(MatShellSetOperation(shell_.get(), operation, reinterpret_cast<void (*)()>(function)));
  };
  set(MATOP_MULT, multiply);
  set(MATOP_GET_DIAGONAL, diagonal);
  set(MATOP_INVERT_BLOCK_DIAGONAL, inverse_diagonal_blocks);
  if (!system_.symmetric()) return;
  set(MATOP_MULT_TRANSPOSE, multiply);
  PDX_CALL(MatSetOption(shell_.get(), MAT_SYMMETRIC, PETSC_TRUE));
  PDX_CALL(MatSetOption(shell_.get(), MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
}

void TangentOperator::update(std::span<const double> u)
{
  static Event event("solve_jacobian");
  Timed timed(event);
  for (const auto& term : system_.terms) term->linearise(u);
  const std::vector<int> moved = moved_terms();
  const bool kept = assemblies_ > 0 && std::ranges::count(moved, 0) > 0;
  if (kept) {
    keep_steady(moved);
    PDX_CALL(MatCopy(steady_.get(), sparse_.get(), SAME_NONZERO_PATTERN));
  } else if (assemblies_) {
    PDX_CALL(MatZeroEntries(sparse_.get()));
  } else {
    reserve_diagonal();
  }
  field::BlockAdder adder(sparse_.get(), *system_.halo, system_.held);
  for (std::size_t t = 0; t < system_.terms.size(); ++t)
    if (!kept || !in_steady_[t]) system_.terms[t]->add_jacobian(adder, assembled_);
  adder.finish(system_.scale);
  hold_weak_rows();
  if (system_.rolls) project_rollers();
  if (shell_) { // tells solvers that the operator changed
    PDX_CALL(MatAssemblyBegin(shell_.get(), MAT_FINAL_ASSEMBLY));
    PDX_CALL(MatAssemblyEnd(shell_.get(), MAT_FINAL_ASSEMBLY));
  }
  ++assemblies_;
}

/// Per Term: 1 if its tangent is not that of the last update, on whatever rank.
std::vector<int> TangentOperator::moved_terms()
{
  std::vector<int> moved;
  revisions_.resize(system_.terms.size(), -1);
  for (std::size_t t = 0; t < system_.terms.size(); ++t) {
    const field::Term& term = *system_.terms[t];
    moved.push_back(!term.constant_jacobian() || term.revision() != revisions_[t]);
    revisions_[t] = term.revision();
  }
  MPI_Allreduce(MPI_IN_PLACE, moved.data(), static_cast<int>(moved.size()), MPI_INT, MPI_LOR, system_.rows.comm);
  return moved;
}

/// While bonds break in a patch, elements and most interfaces stay as they are: their sum is assembled once more and
/// then copied, until one of them changes too.
void TangentOperator::keep_steady(const std::vector<int>& moved)
{
  PetscObjectState pattern = 0;
  PDX_CALL(MatGetNonzeroState(sparse_.get(), &pattern));
  if (pattern != pattern_) steady_.reset(); // what comes to touch has places of its own
  pattern_ = pattern;
  bool valid = static_cast<bool>(steady_);
  for (std::size_t t = 0; valid && t < moved.size(); ++t) valid = !moved[t] || !in_steady_[t];
  if (valid) return;
  if (!steady_) {
    PDX_CALL(MatDuplicate(sparse_.get(), MAT_DO_NOT_COPY_VALUES, steady_.out()));
    PDX_CALL(MatSetOption(steady_.get(), MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  }
  PDX_CALL(MatZeroEntries(steady_.get()));
  in_steady_.assign(moved.size(), 0);
  field::BlockAdder adder(steady_.get(), *system_.halo, system_.held);
  for (std::size_t t = 0; t < moved.size(); ++t) {
    in_steady_[t] = !moved[t];
    if (in_steady_[t]) system_.terms[t]->add_jacobian(adder, assembled_);
  }
  adder.finish(0.0);
}

/// Assembly gives back places where nothing was put; a row without any stiffness needs its own later.
void TangentOperator::reserve_diagonal()
{
  const field::Rows& rows = system_.rows;
  const Block nothing = Block::Zero(rows.dim, rows.dim);
  for (PetscInt row = rows.first; row < rows.first + rows.owned(); ++row)
    PDX_CALL(MatSetValuesBlocked(sparse_.get(), 1, &row, 1, &row, nothing.data(), ADD_VALUES));
}

/// P K P, and the scale along the rollers: places of K have room for it, as all of a block is put in at once.
void TangentOperator::project_rollers()
{
  const PetscInt dim = system_.rows.dim, base = system_.rows.first * dim, local = system_.rows.owned() * dim;
  if (!projector_) {
    PDX_CALL(MatCreateAIJ(system_.rows.comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, static_cast<PetscInt>(dim),
                          nullptr, 0, nullptr, projector_.out()));
    for (PetscInt k = base; k < base + local; ++k) PDX_CALL(MatSetValue(projector_.get(), k, k, 1.0, ADD_VALUES));
    add_along_rollers(projector_.get(), -1.0);
  }
  MatHandle projected;
  PDX_CALL(MatPtAP(sparse_.get(), projector_.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, projected.out()));
  PDX_CALL(MatCopy(projected.get(), sparse_.get(), DIFFERENT_NONZERO_PATTERN));
  add_along_rollers(sparse_.get(), system_.scale);
}

/// Adds `factor` n n^T at each roller. Collective.
void TangentOperator::add_along_rollers(Mat matrix, double factor) const
{
  const int dim = system_.rows.dim;
  for (const field::Roller& roller : system_.rollers) {
    const PetscInt first = (system_.rows.first + roller.row) * dim;
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        PDX_CALL(MatSetValue(matrix, first + a, first + b, factor * roller.along[a] * roller.along[b], ADD_VALUES));
  }
  PDX_CALL(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

TangentOperator::Block TangentOperator::diagonal_block(Index row) const
{
  const int dim = system_.rows.dim;
  std::array<PetscInt, 3> at{};
  for (int a = 0; a < dim; ++a) at[static_cast<std::size_t>(a)] = (system_.rows.first + row) * dim + a;
  Block block(dim, dim);
  PDX_CALL(MatGetValues(sparse_.get(), dim, at.data(), dim, at.data(), block.data()));
  return block;
}

void TangentOperator::hold_weak_rows()
{
  std::vector<Index> candidates;
  for (const auto& term : system_.terms) term->weak_rows(candidates);
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  weak_.clear();
  for (const Index row : candidates) {
    const Block block = diagonal_block(row);
    const SymmetricModes modes = symmetric_modes(0.5 * (block + block.transpose()));
    Block free = Block::Zero(block.rows(), block.cols());
    for (int k = 0; k < system_.rows.dim; ++k)
      if (modes.values[k] < kNoStiffness * system_.scale)
        free += modes.vectors.col(k) * modes.vectors.col(k).transpose();
    if (!free.isZero()) weak_.push_back({row, free});
  }
  held_rows_ = static_cast<std::int64_t>(weak_.size());
  MPI_Allreduce(MPI_IN_PLACE, &held_rows_, 1, MPI_INT64_T, MPI_SUM, system_.rows.comm);
  if (!held_rows_) return;
  for (const WeakRow& weak : weak_) {
    const PetscInt row = system_.rows.first + weak.row;
    const Block stiffness = system_.scale * weak.free;
    PDX_CALL(MatSetValuesBlocked(sparse_.get(), 1, &row, 1, &row, stiffness.data(), ADD_VALUES));
  }
  PDX_CALL(MatAssemblyBegin(sparse_.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(sparse_.get(), MAT_FINAL_ASSEMBLY));
}

void TangentOperator::drop_held(std::span<double> r) const
{
  const int dim = system_.rows.dim;
  for (const WeakRow& weak : weak_) {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>> force(r.data() + weak.row * dim, dim);
    force -= (weak.free * force).eval();
  }
}

/// y = sparse x + what the Terms add; prescribed components pass through with `scale`, as in the sparse part.
void TangentOperator::apply(Vec x, Vec y)
{
  PDX_CALL(MatMult(sparse_.get(), x, y));
  const double* from = nullptr;
  double* to = nullptr;
  PDX_CALL(VecGetArrayRead(x, &from));
  PDX_CALL(VecGetArray(y, &to));
  const auto size = static_cast<std::size_t>(system_.rows.owned() * system_.rows.dim);
  std::span<const double> free{from, size};
  const bool clean = std::all_of(held_components_.begin(), held_components_.end(),
                                 [&](Index k) { return from[static_cast<std::size_t>(k)] == 0.0; });
  if (!clean) {
    masked_.assign(from, from + size);
    for (const Index k : held_components_) masked_[static_cast<std::size_t>(k)] = 0.0;
    free = masked_;
  }
  for (const auto& term : system_.terms) term->add_tangent_action(free, {to, size});
  for (const Index k : held_components_) to[k] = system_.scale * from[k];
  PDX_CALL(VecRestoreArray(y, &to));
  PDX_CALL(VecRestoreArrayRead(x, &from));
}

PetscErrorCode TangentOperator::multiply(Mat shell, Vec x, Vec y)
{
  return guard([&] {
    TangentOperator* self = nullptr;
    PDX_CALL(MatShellGetContext(shell, &self));
    self->apply(x, y);
  });
}

PetscErrorCode TangentOperator::diagonal(Mat shell, Vec d)
{
  return guard([&] {
    TangentOperator* self = nullptr;
    PDX_CALL(MatShellGetContext(shell, &self));
    PDX_CALL(MatGetDiagonal(self->sparse_.get(), d));
  });
}

PetscErrorCode TangentOperator::inverse_diagonal_blocks(Mat shell, const PetscScalar** values)
{
  return guard([&] {
    TangentOperator* self = nullptr;
    PDX_CALL(MatShellGetContext(shell, &self));
    PDX_CALL(MatInvertBlockDiagonal(self->sparse_.get(), values));
  });
}
} // namespace pdx::solve
