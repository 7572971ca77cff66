#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/law/elastic.hpp"

#include <cmath>
#include <numbers>

namespace pdx::law {
/// What a known field around the tip of a straight crack with free faces is loaded by: opening with K_I = 1 Pa m^0.5,
/// sliding with K_II = 1 Pa m^0.5 [Williams, 1957], or a force of 1 N per metre of thickness on the tip, the way the
/// crack looks [Kfouri, 1986].
enum class TipLoad { opening, sliding, force };

/// Displacement at r [m] and angle [rad] from the direction of the crack; its faces are at -pi and pi. In the frame of
/// the tip: along the crack, and to its left [m].
inline Vector<2> tip_displacement(TipLoad load, const Elastic& elastic, double r, double angle)
{
  using std::numbers::pi;
  const double mu = elastic.mu(), nu = elastic.poisson;
  const double kappa = elastic.plane == Plane::stress ? (3.0 - nu) / (1.0 + nu) : 3.0 - 4.0 * nu;
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle), root = std::sqrt(r / (2.0 * pi)) / (2.0 * mu);
  if (load == TipLoad::opening)
    return root * Vector<2>(c * (kappa - 1.0 + 2.0 * s * s), s * (kappa + 1.0 - 2.0 * c * c));
  if (load == TipLoad::sliding)
    return root * Vector<2>(s * (kappa + 1.0 + 2.0 * c * c), -c * (kappa - 1.0 - 2.0 * s * s));
  const double sine = std::sin(angle), cosine = std::cos(angle), scale = 1.0 / (8.0 * pi * mu);
  return scale *
         Vector<2>(-(kappa + 1.0) * std::log(r) - 2.0 * sine * sine, -(kappa - 1.0) * angle + 2.0 * sine * cosine);
}

/// Gradient du_i/dx_j of `tip_displacement` in the frame of the tip [-].
inline Tensor<2> tip_gradient(TipLoad load, const Elastic& elastic, double r, double angle)
{
  using std::numbers::pi;
  const double mu = elastic.mu(), nu = elastic.poisson;
  const double kappa = elastic.plane == Plane::stress ? (3.0 - nu) / (1.0 + nu) : 3.0 - 4.0 * nu;
  const double c = std::cos(0.5 * angle), s = std::sin(0.5 * angle), sine = std::sin(angle), cosine = std::cos(angle);
  const Vector<2> u = tip_displacement(load, elastic, r, angle);
  Vector<2> by_r = 0.5 / r * u, by_angle = Vector<2>::Zero(); // by_r of u ~ sqrt(r)
  const double root = std::sqrt(r / (2.0 * pi)) / (2.0 * mu);
  switch (load) {
  case TipLoad::opening:
    by_angle = 0.5 * root *
               Vector<2>(-s * (kappa - 1.0 + 2.0 * s * s) + 4.0 * c * c * s,
                         c * (kappa + 1.0 - 2.0 * c * c) + 4.0 * s * s * c);
    break;
  case TipLoad::sliding:
    by_angle =
        0.5 * root *
        Vector<2>(c * (kappa + 1.0 + 2.0 * c * c) - 4.0 * s * s * c, s * (kappa - 1.0 - 2.0 * s * s) + 4.0 * c * c * s);
    break;
  case TipLoad::force: {
    const double scale = 1.0 / (8.0 * pi * mu);
    by_r = scale * Vector<2>(-(kappa + 1.0) / r, 0.0);
    by_angle = scale * Vector<2>(-4.0 * sine * cosine, -(kappa - 1.0) + 2.0 * (cosine * cosine - sine * sine));
    break;
  }
  }
  Tensor<2> gradient;
  gradient.col(0) = cosine * by_r - sine / r * by_angle;
  gradient.col(1) = sine * by_r + cosine / r * by_angle;
  return gradient;
}
} // namespace pdx::law
