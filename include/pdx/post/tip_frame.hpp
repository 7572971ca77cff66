#pragma once
#include "pdx/post/tip_modes.hpp"

namespace pdx::post {
constexpr law::TipLoad kTipLoads[] = {law::TipLoad::opening, law::TipLoad::sliding, law::TipLoad::force};

/// The known fields around a tip, in the coordinates of the body.
class TipFrame {
public:
  explicit TipFrame(const crack::Tip& tip)
      : at_(tip.at), to_body_{{tip.direction.x(), -tip.direction.y()}, {tip.direction.y(), tip.direction.x()}}
  {}

  Vector<2> displacement(law::TipLoad load, const law::Elastic& law, const Vector<2>& x, const SideOfCrack& side) const
  {
    const Place p = place(x, side);
    return to_body_ * law::tip_displacement(load, law, p.r, p.angle);
  }

  Tensor<2> gradient(law::TipLoad load, const law::Elastic& law, const Vector<2>& x, const SideOfCrack& side) const
  {
    const Place p = place(x, side);
    return to_body_ * law::tip_gradient(load, law, p.r, p.angle) * to_body_.transpose();
  }

private:
  struct Place {
    double r, angle;
  };
  /// The angle goes on across the tip's prolongation to where the crack runs.
  Place place(const Vector<2>& x, const SideOfCrack& side) const
  {
    const Vector<2> y = to_body_.transpose() * (x - at_);
    double angle = std::atan2(y.y(), y.x());
    if (y.x() < 0.0) {
      const int left = side(x);
      if (left > 0 && angle < 0.0) angle += 2.0 * std::numbers::pi;
      if (left < 0 && angle > 0.0) angle -= 2.0 * std::numbers::pi;
    }
    return {y.norm(), angle};
  }

  Vector<2> at_;
  Tensor<2> to_body_; ///< rotates
};
} // namespace pdx::post
