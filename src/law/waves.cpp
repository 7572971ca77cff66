#include "pdx/law/waves.hpp"

#include <cmath>

namespace pdx::law {
double pressure_speed(const Elastic& elastic) { return std::sqrt(elastic.c11() / elastic.density); }

double shear_speed(const Elastic& elastic) { return std::sqrt(elastic.mu() / elastic.density); }

double rayleigh_speed(const Elastic& elastic)
{
  const double k = elastic.mu() / elastic.c11();
  double lower = 0.0, upper = 1.0; // the cubic is negative at 0, 1 at 1
  for (int step = 0; step < 60; ++step) {
    const double z = 0.5 * (lower + upper);
    const double cubic = ((z - 8.0) * z + 24.0 - 16.0 * k) * z - 16.0 * (1.0 - k);
    (cubic < 0.0 ? lower : upper) = z;
  }
  return std::sqrt(0.5 * (lower + upper)) * shear_speed(elastic);
}
} // namespace pdx::law
