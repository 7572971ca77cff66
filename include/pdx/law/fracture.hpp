#pragma once
#include "pdx/law/elastic.hpp"

#include <cmath>

namespace pdx::law {
/// Young's modulus of cracks, E' = E in plane stress, E / (1 - nu^2) in plane strain.   [Pa]
inline double crack_modulus(const Elastic& elastic)
{
  if (elastic.plane == Plane::stress) return elastic.young;
  return elastic.young / (1.0 - elastic.poisson * elastic.poisson);
}

/// K = sqrt(J E') of a crack loaded in mode I alone; 0 where J is not positive.   [Pa m^0.5]
/// @param j energy release rate [J/m^2]
inline double stress_intensity(double j, const Elastic& elastic)
{
  return j > 0.0 ? std::sqrt(j * crack_modulus(elastic)) : 0.0;
}
} // namespace pdx::law
