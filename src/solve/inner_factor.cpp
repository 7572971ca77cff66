#include "pdx/solve/inner_factor.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::solve {
namespace {
constexpr double kSound = 1e-4; // residual of a solve over its right-hand side; a singular matrix leaves about 1

/// One row of a sequential MATAIJ.
class Row {
public:
  Row(Mat matrix, PetscInt row) : matrix_(matrix), row_(row)
  {
    PDX_CALL(MatGetRow(matrix_, row_, &count_, &columns_, &values_));
  }
  ~Row() { (void)MatRestoreRow(matrix_, row_, &count_, &columns_, &values_); }
  Row(const Row&) = delete;
  Row& operator=(const Row&) = delete;
  template <class Visit> void for_each(Visit&& visit) const
  {
    for (PetscInt k = 0; k < count_; ++k) visit(columns_[k], values_[k]);
  }

private:
  Mat matrix_;
  PetscInt row_, count_ = 0;
  const PetscInt* columns_ = nullptr;
  const PetscScalar* values_ = nullptr;
};

PetscInt rows_of(Mat matrix)
{
  PetscInt rows = 0;
  PDX_CALL(MatGetSize(matrix, &rows, nullptr));
  return rows;
}

VecHandle vector_of(const std::vector<double>& values, std::size_t size)
{
  VecHandle v;
  PDX_CALL(VecCreateSeq(PETSC_COMM_SELF, static_cast<PetscInt>(size), v.out()));
  double* to = nullptr;
  PDX_CALL(VecGetArrayWrite(v.get(), &to));
  std::fill_n(std::copy(values.begin(), values.end(), to), size - values.size(), 0.0);
  PDX_CALL(VecRestoreArrayWrite(v.get(), &to));
  return v;
}

std::vector<double> first_of(Vec v, std::size_t count)
{
  const double* from = nullptr;
  PDX_CALL(VecGetArrayRead(v, &from));
  std::vector<double> values(from, from + count);
  PDX_CALL(VecRestoreArrayRead(v, &from));
  return values;
}
} // namespace

GatheredMatrix::GatheredMatrix(Mat matrix)
{
  MPI_Comm comm = MPI_COMM_NULL;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(matrix), &comm));
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) {
    whole_ = matrix;
    return;
  }
  const PetscInt wanted = rank == 0 ? rows_of(matrix) : 0;
  IS all = nullptr;
  Mat* found = nullptr;
  PDX_CALL(ISCreateStride(PETSC_COMM_SELF, wanted, 0, 1, &all));
  PDX_CALL(MatCreateSubMatrices(matrix, 1, &all, &all, MAT_INITIAL_MATRIX, &found));
  PDX_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(found[0])));
  *own_.out() = found[0];
  PDX_CALL(MatDestroySubMatrices(1, &found));
  PDX_CALL(ISDestroy(&all));
  if (rank == 0) whole_ = own_.get();
}

std::vector<double> pick(std::span<const double> values, std::span<const PetscInt> places)
{
  std::vector<double> picked;
  picked.reserve(places.size());
  for (const PetscInt place : places) picked.push_back(values[static_cast<std::size_t>(place)]);
  return picked;
}

void subtract_product(Mat a, std::span<const PetscInt> columns, std::span<const double> values, std::vector<double>& y)
{
  for (std::size_t k = 0; k < columns.size(); ++k) // symmetric: by columns as by rows
    if (values[k] != 0.0)
      Row(a, columns[k]).for_each([&](PetscInt row, double entry) {
        y[static_cast<std::size_t>(row)] -= entry * values[k];
      });
}

InnerFactor::InnerFactor(Mat k, std::span<const PetscInt> inner, std::span<const PetscInt> outer,
                         std::vector<double>& condensed)
    : inner_(inner.size()), outer_(outer.size())
{
  const MatHandle whole = matrix(k, inner, outer);
  PetscBool there = PETSC_FALSE;
  PDX_CALL(MatGetFactorAvailable(whole.get(), MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, &there));
  if (!there) {
    fault_ = "this PETSc has no MUMPS";
    return;
  }
  PDX_CALL(MatGetFactor(whole.get(), MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, factor_.out()));
  IS last = nullptr;
  PDX_CALL(ISCreateStride(PETSC_COMM_SELF, static_cast<PetscInt>(outer_), static_cast<PetscInt>(inner_), 1, &last));
  PDX_CALL(MatFactorSetSchurIS(factor_.get(), last));
  PDX_CALL(ISDestroy(&last));
  MatFactorInfo info;
  PDX_CALL(MatFactorInfoInitialize(&info));
  PDX_CALL(MatCholeskyFactorSymbolic(factor_.get(), whole.get(), nullptr, &info));
  PDX_CALL(MatCholeskyFactorNumeric(factor_.get(), whole.get(), &info));
  MatFactorError error = MAT_FACTOR_NOERROR;
  PDX_CALL(MatFactorGetError(factor_.get(), &error));
  if (error != MAT_FACTOR_NOERROR) {
    fault_ = "the elements alone are singular";
    return;
  }
  MatHandle schur;
  MatFactorSchurStatus status = MAT_FACTOR_SCHUR_UNFACTORED;
  PDX_CALL(MatFactorCreateSchurComplement(factor_.get(), schur.out(), &status));
  const double* values = nullptr;
  PetscInt stride = 0;
  PDX_CALL(MatDenseGetArrayRead(schur.get(), &values));
  PDX_CALL(MatDenseGetLDA(schur.get(), &stride));
  condensed.resize(outer_ * outer_);
  for (std::size_t c = 0; c < outer_; ++c)
    std::copy_n(values + c * static_cast<std::size_t>(stride), outer_,
                condensed.begin() + static_cast<std::ptrdiff_t>(c * outer_));
  PDX_CALL(MatDenseRestoreArrayRead(schur.get(), &values));
  PDX_CALL(MatMumpsSetIcntl(factor_.get(), 26, 0)); // from here on solves are for K_II alone
  judge(whole.get());
}

/// [I | G] of K, and what couples the two.
MatHandle InnerFactor::matrix(Mat k, std::span<const PetscInt> inner, std::span<const PetscInt> outer)
{
  const auto size = static_cast<PetscInt>(inner_ + outer_);
  std::vector<PetscInt> place(static_cast<std::size_t>(rows_of(k)), -1), counts;
  PetscInt next = 0;
  for (const auto& part : {inner, outer})
    for (const PetscInt component : part) place[static_cast<std::size_t>(component)] = next++;
  for (const auto& part : {inner, outer})
    for (const PetscInt component : part) {
      PetscInt count = 0;
      Row(k, component).for_each([&](PetscInt column, double) {
        count += place[static_cast<std::size_t>(column)] >= 0;
      });
      counts.push_back(count);
    }
  MatHandle whole;
  PDX_CALL(MatCreateSeqAIJ(PETSC_COMM_SELF, size, size, 0, counts.data(), whole.out()));
  std::vector<PetscInt> columns;
  std::vector<double> values;
  PetscInt row = 0;
  for (const auto& part : {inner, outer})
    for (const PetscInt component : part) {
      columns.clear();
      values.clear();
      Row(k, component).for_each([&](PetscInt column, double value) {
        const PetscInt to = place[static_cast<std::size_t>(column)];
        if (to < 0) return;
        columns.push_back(to);
        values.push_back(value);
        if (row < static_cast<PetscInt>(inner_) && to >= static_cast<PetscInt>(inner_))
          between_.push_back({row, to - static_cast<PetscInt>(inner_), value});
      });
      PDX_CALL(MatSetValues(whole.get(), 1, &row, static_cast<PetscInt>(columns.size()), columns.data(), values.data(),
                            INSERT_VALUES));
      ++row;
    }
  PDX_CALL(MatAssemblyBegin(whole.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(whole.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatSetOption(whole.get(), MAT_SYMMETRIC, PETSC_TRUE));
  PDX_CALL(MatSetOption(whole.get(), MAT_SPD, PETSC_TRUE)); // of K_II, all that is factored
  return whole;
}

/// What hangs on nothing makes K_II singular to rounding, which a factor need not notice.
void InnerFactor::judge(Mat whole)
{
  std::vector<double> force(inner_);
  for (std::size_t c = 0; c < inner_; ++c) force[c] = std::sin(static_cast<double>(c) + 1.0);
  const VecHandle x = vector_of(solve(force), inner_ + outer_);
  VecHandle f;
  PDX_CALL(VecDuplicate(x.get(), f.out()));
  PDX_CALL(MatMult(whole, x.get(), f.get()));
  const std::vector<double> found = first_of(f.get(), inner_);
  double worst = 0.0;
  bool finite = true;
  for (std::size_t c = 0; c < inner_; ++c) {
    worst = std::max(worst, std::abs(found[c] - force[c]));
    finite = finite && std::isfinite(found[c]);
  }
  if (!finite || worst > kSound) fault_ = "elements hang on nothing that is held or has particles";
}

std::vector<double> InnerFactor::solve(std::vector<double> f) const
{
  if (f.empty()) return f;
  const VecHandle b = vector_of(f, inner_ + outer_);
  VecHandle x;
  PDX_CALL(VecDuplicate(b.get(), x.out()));
  PDX_CALL(MatSolve(factor_.get(), b.get(), x.get()));
  return first_of(x.get(), inner_);
}

std::vector<double> InnerFactor::answer(std::span<const double> x) const
{
  std::vector<double> force(inner_, 0.0);
  for (const Entry& e : between_)
    force[static_cast<std::size_t>(e.inner)] -= e.value * x[static_cast<std::size_t>(e.outer)];
  return solve(std::move(force));
}

std::vector<double> InnerFactor::condensed(std::vector<double> f, std::span<const double> u) const
{
  for (const Entry& e : between_)
    f[static_cast<std::size_t>(e.outer)] -= e.value * u[static_cast<std::size_t>(e.inner)];
  return f;
}
} // namespace pdx::solve
