#pragma once

#include <Eigen/Core>

/// Small symmetric matrices of any size, of which the lower triangle is read. Compiled once: each size of Eigen's
/// solver costs a source that uses it ten seconds. For millions of 2 x 2 and 3 x 3 matrices use Eigen's own.
namespace pdx {

/// Eigenvalues, rising, and unit eigenvectors as columns.
struct SymmetricModes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricModes symmetric_modes(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// Eigenvalues, rising.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::Ref<const Eigen::MatrixXd>& matrix);

/// The x of least norm with A x = B, column by column: modes of A with at most `least` of its largest eigenvalue say
/// nothing.
Eigen::MatrixXd least_solution(const Eigen::Ref<const Eigen::MatrixXd>& a, const Eigen::Ref<const Eigen::MatrixXd>& b,
                               double least);

} // namespace pdx
