#pragma once
#include "pdx/base/petsc.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

namespace pdx::solve {
/// Solves with a symmetric positive definite matrix of which the components G are coupled each with each and the
/// others, X, sparsely: Cholesky of K_XX, and the inverse of the Schur complement on G. On several ranks each has the
/// whole of it, as on a coarse level.
class BorderedFactor {
public:
  /// @param matrix MATAIJ  @param dense how many of our first components are of G. Collective.
  BorderedFactor(Mat matrix, PetscInt dense);
  /// y = K^-1 x. Collective.
  void solve(Vec x, Vec y) const;

private:
  using Dense = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using Sparse = Eigen::SparseMatrix<double>;
  void split(Mat whole);
  void factor(Dense border);
  void eliminate_inside(Dense& border);

  MPI_Comm comm_ = MPI_COMM_NULL;
  int ranks_ = 1;
  PetscInt first_ = 0, owned_ = 0;       // our components
  std::vector<PetscInt> dense_, sparse_; // components of all ranks
  Sparse inside_, between_;              // K_XX, K_XG
  Dense outside_;                        // K_GG
  Eigen::SimplicialLLT<Sparse> inner_;
  Dense inverse_;           // of the Schur complement; empty where it is too large
  Eigen::LLT<Dense> outer_; // then
  mutable Eigen::VectorXd x_, y_, pull_;
};
} // namespace pdx::solve
