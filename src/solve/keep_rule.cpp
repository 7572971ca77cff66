#include "pdx/solve/keep_rule.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
constexpr int kSlack = 2;       // iterations
constexpr double kPrice = 10.0; // of a build, in iterations
} // namespace

void KeepRule::built()
{
  wanted_ = false;
  per_decade_ = spent_ = 0.0;
}

void KeepRule::solved(int iterations, double decades)
{
  if (iterations == 0) return;
  decades = std::clamp(decades, 1.0, 16.0);
  if (per_decade_ == 0.0) {
    per_decade_ = iterations / decades;
    return;
  }
  const double expected = per_decade_ * decades;
  spent_ = std::max(0.0, spent_ + iterations - expected);
  if (iterations > factor_ * expected + kSlack || spent_ > kPrice) wanted_ = true;
}
} // namespace pdx::solve
