#include "pdx/solve/dense_elimination.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// Positive definite, of no pattern.
Eigen::MatrixXd matrix_of(Eigen::Index size)
{
  Eigen::MatrixXd a(size, size);
  for (Eigen::Index r = 0; r < size; ++r)
    for (Eigen::Index c = 0; c < size; ++c) a(r, c) = std::sin(static_cast<double>(1 + 7 * r + 3 * c * c));
  return a * a.transpose() + Eigen::MatrixXd::Identity(size, size);
}

solve::DenseSquare upper(const Eigen::MatrixXd& a)
{
  solve::DenseSquare square(static_cast<std::size_t>(a.rows()));
  for (Eigen::Index r = 0; r < a.rows(); ++r)
    for (Eigen::Index c = r; c < a.cols(); ++c) square.row(static_cast<std::size_t>(r))[c] = a(r, c);
  return square;
}
} // namespace

TEST(DenseElimination, LeavesTheSchurComplementForAnySize)
{
  for (const Eigen::Index first : {0, 1, 5, 31, 32, 33, 70})
    for (const Eigen::Index rest : {1, 3, 16, 45}) {
      const Eigen::Index size = first + rest;
      const Eigen::MatrixXd a = matrix_of(size);
      const solve::DenseElimination gone(upper(a), static_cast<std::size_t>(first));
      ASSERT_TRUE(gone.sound());
      const Eigen::MatrixXd pulled = a.topLeftCorner(first, first).llt().solve(a.topRightCorner(first, rest));
      const Eigen::MatrixXd left = a.bottomRightCorner(rest, rest) - a.bottomLeftCorner(rest, first) * pulled;
      const std::vector<double> found = gone.schur();
      const Eigen::Map<const Eigen::MatrixXd> schur(found.data(), rest, rest);
      EXPECT_LT((schur - left).cwiseAbs().maxCoeff(), 1e-12 * a.cwiseAbs().maxCoeff()) << first << " and " << rest;

      // A x = f, the rest by its Schur complement, the first by what it comes to.
      const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(size, -1.0, 2.0), f = a * x;
      std::vector<double> both(f.data(), f.data() + size);
      gone.condense(both);
      Eigen::Map<Eigen::VectorXd> values(both.data(), size);
      EXPECT_LT((left * x.tail(rest) - values.tail(rest)).norm(), 1e-11 * f.norm());
      values.tail(rest) = x.tail(rest);
      gone.answer(both);
      EXPECT_LT((values - x).norm(), 1e-9 * x.norm());
    }
}

TEST(DenseElimination, SeesWhatHangsOnNothing)
{
  Eigen::MatrixXd a = matrix_of(6);
  a.topRows(2).setZero();
  a.leftCols(2).setZero();
  a(0, 0) = a(1, 1) = 3.0;
  a(0, 1) = a(1, 0) = -3.0; // a spring between two that have no other
  EXPECT_FALSE(solve::DenseElimination(upper(a), 4).sound());
  EXPECT_TRUE(solve::DenseElimination(upper(matrix_of(6)), 4).sound());
}
