#pragma once
#include "pdx/fem/element.hpp"
#include "pdx/fem/shape.hpp"
#include "pdx/law/elastic.hpp"

namespace pdx::fem {
/// What a free strain e(x) does to an element of small strain, whose stress is C (strain - e I) = C strain - p I with
/// p = (c11 + c12) e: the internal force K u loses `force`, and the energy is 1/2 u.K u - force.u + energy.
struct SwellingLoad {
  ElementVector force = ElementVector::Zero(); ///< int p grad N t dA [N]
  double energy = 0.0;                         ///< int p e t dA [J]

  /// @param strain at the point [-]
  void add(const QuadraturePoint& at, double strain, const law::Elastic& law)
  {
    const double pressure = law.swelling_stress(strain), volume = at.area * law.thickness;
    force += pressure * volume * Eigen::Map<const ElementVector>(at.gradients.data());
    energy += pressure * strain * volume;
  }
};

/// Of a whole element. @param strain by place [m]
template <class FreeStrain>
SwellingLoad swelling_load(const Corners& corners, const law::Elastic& law, const FreeStrain& strain)
{
  SwellingLoad load;
  const Gradients points = gauss_points();
  for (int g = 0; const QuadraturePoint& at : gauss_rule(corners))
    load.add(at, strain(place_of(corners, shape(points.col(g++)))), law);
  return load;
}
} // namespace pdx::fem
