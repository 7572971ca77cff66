#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/law/elastic.hpp"

#include <cmath>
#include <numbers>

namespace pdx::test {
/// A smooth displacement on the unit square without symmetry, u = (sin(p x) sin(q y), cos(q x) cos(p y)), and the body
/// force that an elastic solid needs for it.
struct Manufactured {
  static constexpr double kP = std::numbers::pi, kQ = 2.0;
  law::Elastic law;

  static Vector<2> displacement(const Vector<2>& x)
  {
    return {std::sin(kP * x.x()) * std::sin(kQ * x.y()), std::cos(kQ * x.x()) * std::cos(kP * x.y())};
  }

  /// b = -(lambda + mu) grad div u - mu laplace u [N/m^3].
  Vector<2> body_force(const Vector<2>& x) const
  {
    const double spx = std::sin(kP * x.x()), sqy = std::sin(kQ * x.y()), cpx = std::cos(kP * x.x()),
                 cqy = std::cos(kQ * x.y()), sqx = std::sin(kQ * x.x()), cqx = std::cos(kQ * x.x()),
                 spy = std::sin(kP * x.y()), cpy = std::cos(kP * x.y());
    const Vector<2> grad_div(-kP * kP * spx * sqy + kP * kQ * sqx * spy, kP * kQ * cpx * cqy - kP * kP * cqx * cpy);
    const Vector<2> laplace = -(kP * kP + kQ * kQ) * displacement(x);
    return -(law.lambda() + law.mu()) * grad_div - law.mu() * laplace;
  }
};
} // namespace pdx::test
