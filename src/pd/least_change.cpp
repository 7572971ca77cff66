#include "least_change.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace pdx::pd {
namespace least_change {
constexpr double kLeast = 0.2, kMost = 3.0; // a factor's bounds
constexpr double kMet = 1e-9;               // a condition, over its largest coefficient
constexpr int kRounds = 500;                // of the active set; a few dozen are needed
} // namespace least_change

void FactorConditions::end()
{
  const double largest = coefficients_.cwiseAbs().maxCoeff();
  if (largest == 0.0) {
    possible_ = possible_ && right_ == 0.0;
    return;
  }
  lines_.push_back(coefficients_ / largest);
  rights_.push_back(right_ / largest);
}

Eigen::MatrixXd FactorConditions::matrix() const
{
  Eigen::MatrixXd a(static_cast<Eigen::Index>(lines_.size()), coefficients_.size());
  for (std::size_t l = 0; l < lines_.size(); ++l) a.row(static_cast<Eigen::Index>(l)) = lines_[l].transpose();
  return a;
}

Eigen::VectorXd FactorConditions::right_side() const
{
  return Eigen::Map<const Eigen::VectorXd>(rights_.data(), static_cast<Eigen::Index>(rights_.size()));
}

std::optional<Eigen::VectorXd> next_to_one(const FactorConditions& conditions, const Eigen::VectorXd& weight)
{
  using namespace least_change;
  if (!conditions.can_be_met()) return std::nullopt;
  const Eigen::MatrixXd a = conditions.matrix();
  const Eigen::VectorXd b = conditions.right_side();
  const Eigen::Index size = a.cols();
  Eigen::VectorXd w = Eigen::VectorXd::Ones(size);
  std::vector<int> held(static_cast<std::size_t>(size), 0); // -1 at kLeast, +1 at kMost
  std::optional<Eigen::VectorXd> found;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd root = weight.cwiseSqrt();
    Eigen::MatrixXd scaled = a * root.cwiseInverse().asDiagonal();
    Eigen::VectorXd missing = b;
    for (Eigen::Index k = 0; k < size; ++k) {
      const int at = held[static_cast<std::size_t>(k)];
      missing -= (at ? w[k] : 1.0) * a.col(k);
      if (at) scaled.col(k).setZero();
    }
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-11);
    solver.compute(scaled);
    const Eigen::VectorXd z = solver.solve(missing);
    if ((scaled * z - missing).cwiseAbs().maxCoeff() > kMet) return found;
    Eigen::Index worst = -1;
    double excess = 1e-12;
    for (Eigen::Index k = 0; k < size; ++k) {
      if (held[static_cast<std::size_t>(k)]) continue;
      w[k] = 1.0 + z[k] / root[k];
      const double out = std::max(kLeast - w[k], w[k] - kMost);
      if (out > excess) worst = k;
      excess = std::max(excess, out);
    }
    if (worst >= 0) {
      held[static_cast<std::size_t>(worst)] = w[worst] < kLeast ? -1 : 1;
      w[worst] = std::clamp(w[worst], kLeast, kMost);
      continue;
    }
    found = w;
    // Multipliers: weight (w - 1) = A^T l for what is free; what is held must push against its bound.
    const Eigen::VectorXd multiplier = scaled.transpose().completeOrthogonalDecomposition().solve(z);
    const Eigen::VectorXd push =
        weight.cwiseProduct(w - Eigen::VectorXd::Ones(size)) - a.transpose() * multiplier; // of the objective
    double pull = 1e-9 * weight.maxCoeff();
    for (Eigen::Index k = 0; k < size; ++k) {
      const double back = held[static_cast<std::size_t>(k)] * push[k];
      if (back > pull) worst = k;
      pull = std::max(pull, back);
    }
    if (worst < 0) return found;
    held[static_cast<std::size_t>(worst)] = 0;
  }
  return found;
}
} // namespace pdx::pd
