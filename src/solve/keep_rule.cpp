#include "pdx/solve/keep_rule.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
constexpr int kSlack = 2; // iterations
} // namespace

void KeepRule::built()
{
  wanted_ = false;
  per_decade_ = 0.0;
}

void KeepRule::solved(int iterations, double decades)
{
  if (iterations == 0) return;
  decades = std::clamp(decades, 1.0, 16.0);
  if (per_decade_ == 0.0)
    per_decade_ = iterations / decades;
  else if (iterations > factor_ * per_decade_ * decades + kSlack)
    wanted_ = true;
}
} // namespace pdx::solve
