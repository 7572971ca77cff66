#include "pdx/base/symmetric.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace pdx;

// Springs of a ring of n masses: eigenvalues 4 sin^2(pi k / n), the sum of all displacements free.
namespace {
Eigen::MatrixXd ring(int n)
{
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n);
  for (int at = 0; at < n; ++at) {
    k(at, at) = 2.0;
    k(at, (at + 1) % n) = k((at + 1) % n, at) = -1.0;
  }
  return k;
}
} // namespace

TEST(Symmetric, FindsTheModesOfARing)
{
  constexpr int kMasses = 7;
  const SymmetricModes modes = symmetric_modes(ring(kMasses));
  const Eigen::VectorXd values = symmetric_eigenvalues(ring(kMasses));
  for (int k = 0; k < kMasses; ++k) {
    const double expected = 4.0 * std::pow(std::sin(M_PI * ((k + 1) / 2) / kMasses), 2); // all but 0 twice
    EXPECT_NEAR(modes.values[k], expected, 1e-14);
    EXPECT_NEAR(values[k], expected, 1e-14);
  }
  EXPECT_NEAR((modes.vectors.transpose() * modes.vectors - Eigen::MatrixXd::Identity(7, 7)).norm(), 0.0, 1e-13);
  EXPECT_NEAR((ring(kMasses) * modes.vectors - modes.vectors * modes.values.asDiagonal()).norm(), 0.0, 1e-13);
}

TEST(Symmetric, ReadsTheLowerTriangle)
{
  Eigen::MatrixXd k = ring(5);
  k.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_NEAR(symmetric_eigenvalues(k)[0], 0.0, 1e-14);
}

TEST(Symmetric, AnswersWithoutWhatTheMatrixDoesNotSay)
{
  // Two forces along the ring that are in balance; what shifts all masses is left at 0.
  Eigen::MatrixXd force = Eigen::MatrixXd::Zero(6, 1);
  force(0, 0) = 1.0;
  force(3, 0) = -1.0;
  const Eigen::MatrixXd u = least_solution(ring(6), force, 1e-10);
  EXPECT_NEAR(u.sum(), 0.0, 1e-14);
  EXPECT_NEAR(u(0, 0) - u(3, 0), 1.5, 1e-13); // two chains of three springs side by side
  EXPECT_NEAR((ring(6) * u - force).norm(), 0.0, 1e-13);
}
