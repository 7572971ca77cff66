#pragma once
#include "pdx/law/elastic.hpp"

namespace pdx::law {
/// Speeds of waves in the plane of a plate; `density` must be positive. [m/s]
double pressure_speed(const Elastic& elastic); ///< sqrt(c11 / rho)
double shear_speed(const Elastic& elastic);    ///< sqrt(mu / rho)
/// Speed of waves along a free surface, which a crack's tip cannot exceed: the root in (0, 1) of
/// z^3 - 8 z^2 + (24 - 16 k) z - 16 (1 - k) = 0, with z = (c_R / c_S)^2 and k = (c_S / c_L)^2 of the plane problem.
double rayleigh_speed(const Elastic& elastic);
} // namespace pdx::law
