#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

namespace pdx::pd {
/// Conditions A w = b on factors, a line each, scaled by its largest coefficient.
class FactorConditions {
public:
  explicit FactorConditions(Eigen::Index factors) : coefficients_(Eigen::VectorXd::Zero(factors)) {}

  void begin()
  {
    coefficients_.setZero();
    right_ = 0.0;
  }
  double& of(Eigen::Index factor) { return coefficients_[factor]; }
  double& right() { return right_; }
  /// A line without coefficients is left out, and cannot be met if it asks for something.
  void end();

  bool can_be_met() const { return possible_; }
  Eigen::MatrixXd matrix() const;
  Eigen::VectorXd right_side() const;

private:
  Eigen::VectorXd coefficients_;
  double right_ = 0.0;
  bool possible_ = true;
  std::vector<Eigen::VectorXd> lines_;
  std::vector<double> rights_;
};

/// The w next to 1 in the norm sum weight (w - 1)^2 with A w = b and all w within [0.2, 3], by an active set: the
/// factor furthest out of bounds is held there, the one that pulls back most is let go. Nothing if there is none.
std::optional<Eigen::VectorXd> next_to_one(const FactorConditions& conditions, const Eigen::VectorXd& weight);
} // namespace pdx::pd
