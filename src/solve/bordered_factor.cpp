#include "pdx/solve/bordered_factor.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/solve/dense_product.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
constexpr double kShift = 1e-8, kMore = 10.0;  // of the largest stiffness; what it grows by until it is enough
constexpr double kMostShift = 0.1;             // likewise, at most
constexpr Eigen::Index kLargestInverse = 1200; // above it the inverse takes longer than it saves

/// The whole matrix on every rank.
MatHandle copied(Mat matrix, PetscInt size)
{
  IS all = nullptr;
  Mat* found = nullptr;
  MatHandle whole;
  PDX_CALL(ISCreateStride(PETSC_COMM_SELF, size, 0, 1, &all));
  PDX_CALL(MatCreateSubMatrices(matrix, 1, &all, &all, MAT_INITIAL_MATRIX, &found));
  PDX_CALL(PetscObjectReference(reinterpret_cast<PetscObject>(found[0])));
  *whole.out() = found[0];
  PDX_CALL(MatDestroySubMatrices(1, &found));
  PDX_CALL(ISDestroy(&all));
  return whole;
}
} // namespace

BorderedFactor::BorderedFactor(Mat matrix, PetscInt dense)
{
  PetscInt end = 0, size = 0;
  PDX_CALL(PetscObjectGetComm(reinterpret_cast<PetscObject>(matrix), &comm_));
  PDX_CALL(MatGetOwnershipRange(matrix, &first_, &end));
  PDX_CALL(MatGetSize(matrix, &size, nullptr));
  owned_ = end - first_;
  std::vector<PetscInt> mine;
  for (PetscInt c = first_; c < first_ + dense; ++c) mine.push_back(c);
  dense_ = gather_all(comm_, mine);
  for (PetscInt c = 0; c < size; ++c)
    if (!std::ranges::binary_search(dense_, c)) sparse_.push_back(c);
  MPI_Comm_size(comm_, &ranks_);
  if (ranks_ == 1) {
    split(matrix);
  } else {
    const MatHandle whole = copied(matrix, size);
    split(whole.get());
  }
  factor(std::move(outside_));
}

void BorderedFactor::split(Mat whole)
{
  const auto border = static_cast<Eigen::Index>(dense_.size()), inside = static_cast<Eigen::Index>(sparse_.size());
  std::vector<PetscInt> place(dense_.size() + sparse_.size());
  std::vector<std::uint8_t> of_border(place.size(), 0);
  for (std::size_t k = 0; k < sparse_.size(); ++k)
    place[static_cast<std::size_t>(sparse_[k])] = static_cast<PetscInt>(k);
  for (std::size_t k = 0; k < dense_.size(); ++k) {
    place[static_cast<std::size_t>(dense_[k])] = static_cast<PetscInt>(k);
    of_border[static_cast<std::size_t>(dense_[k])] = 1;
  }
  outside_ = Dense::Zero(border, border);
  std::vector<Eigen::Triplet<double>> within, between;
  for (PetscInt row = 0; row < static_cast<PetscInt>(place.size()); ++row) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    PDX_CALL(MatGetRow(whole, row, &count, &columns, &values));
    const PetscInt at = place[static_cast<std::size_t>(row)];
    for (PetscInt k = 0; k < count; ++k) {
      const auto column = static_cast<std::size_t>(columns[k]);
      if (of_border[static_cast<std::size_t>(row)]) {
        if (of_border[column]) outside_(at, place[column]) += values[k];
      } else
        (of_border[column] ? between : within).emplace_back(at, place[column], values[k]);
    }
    PDX_CALL(MatRestoreRow(whole, row, &count, &columns, &values));
  }
  inside_.resize(inside, inside);
  inside_.setFromTriplets(within.begin(), within.end());
  between_.resize(inside, border);
  between_.setFromTriplets(between.begin(), between.end());
}

void BorderedFactor::factor(Dense border)
{
  if (inside_.rows() > 0) eliminate_inside(border);
  outer_.compute(border);
  const double largest = border.rows() > 0 ? border.diagonal().cwiseAbs().maxCoeff() : 0.0;
  for (double shift = kShift; outer_.info() != Eigen::Success && shift <= kMostShift; shift *= kMore) {
    border.diagonal().array() += shift * largest;
    outer_.compute(border);
  }
  if (outer_.info() != Eigen::Success) throw SolverFailure("the coarse level of the elements is not positive definite");
  if (border.rows() > kLargestInverse) return;
  inverse_ = outer_.solve(Dense::Identity(border.rows(), border.rows()));
  inverse_ = 0.5 * (inverse_ + inverse_.transpose().eval());
}

/// What hangs by nothing but rounding gets a little stiffness.
void BorderedFactor::eliminate_inside(Dense& border)
{
  inner_.compute(inside_);
  for (double shift = kShift; inner_.info() != Eigen::Success && shift <= kMostShift; shift *= kMore) {
    inner_.setShift(shift * inside_.diagonal().cwiseAbs().maxCoeff());
    inner_.compute(inside_);
  }
  if (inner_.info() != Eigen::Success) throw SolverFailure("the coarse level of particles is not positive definite");
  inside_.resize(0, 0);
  constexpr Eigen::Index kBlock = 64; // columns at a time: few touch the border, and the rest need no room at once
  for (Eigen::Index begin = 0; begin < border.cols(); begin += kBlock) {
    const Eigen::Index width = std::min(kBlock, border.cols() - begin);
    const Eigen::MatrixXd pulled = inner_.solve(Eigen::MatrixXd(between_.middleCols(begin, width)));
    border.middleCols(begin, width) -= between_.transpose() * pulled;
  }
}

void BorderedFactor::solve(Vec x, Vec y) const
{
  const double* from = nullptr;
  double* to = nullptr;
  PDX_CALL(VecGetArrayRead(x, &from));
  std::vector<double> gathered;
  const double* all = from;
  if (ranks_ > 1) {
    gathered = gather_all(comm_, std::vector<double>(from, from + owned_));
    all = gathered.data();
  }
  const auto border = static_cast<Eigen::Index>(dense_.size()), inside = static_cast<Eigen::Index>(sparse_.size());
  x_.resize(inside);
  pull_.resize(border);
  for (Eigen::Index k = 0; k < inside; ++k) x_[k] = all[sparse_[static_cast<std::size_t>(k)]];
  for (Eigen::Index k = 0; k < border; ++k) pull_[k] = all[dense_[static_cast<std::size_t>(k)]];
  PDX_CALL(VecRestoreArrayRead(x, &from));
  if (inside > 0) {
    y_ = inner_.solve(x_);
    pull_ -= between_.transpose() * y_;
  }
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(border);
  if (inverse_.size() > 0)
    add_dense_product(inverse_.data(), static_cast<std::size_t>(border), static_cast<std::size_t>(border), pull_.data(),
                      moved.data());
  else
    moved = outer_.solve(pull_);
  if (inside > 0) {
    x_ -= between_ * moved;
    y_ = inner_.solve(x_);
  }
  PDX_CALL(VecGetArrayWrite(y, &to));
  const auto put = [&](PetscInt component, double value) {
    if (component >= first_ && component < first_ + owned_) to[component - first_] = value;
  };
  for (Eigen::Index k = 0; k < inside; ++k) put(sparse_[static_cast<std::size_t>(k)], y_[k]);
  for (Eigen::Index k = 0; k < border; ++k) put(dense_[static_cast<std::size_t>(k)], moved[k]);
  PDX_CALL(VecRestoreArrayWrite(y, &to));
}
} // namespace pdx::solve
