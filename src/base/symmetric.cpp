#include "pdx/base/symmetric.hpp"

#include <Eigen/Eigenvalues>

namespace pdx {

SymmetricModes symmetric_modes(const Eigen::Ref<const Eigen::MatrixXd>& matrix)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::Ref<const Eigen::MatrixXd>& matrix)
{
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd least_solution(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b,
                               double least)
{
  const SymmetricModes modes = symmetric_modes(a);
  const double none = least * modes.values.maxCoeff();
  const Eigen::VectorXd inverse = modes.values.unaryExpr([none](double v) { return v > none ? 1.0 / v : 0.0; });
  return modes.vectors * (inverse.asDiagonal() * (modes.vectors.transpose() * b)).eval();
}

} // namespace pdx
