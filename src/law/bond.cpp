#include "pdx/law/bond.hpp"

#include "pdx/base/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace pdx::law {
namespace {
constexpr double kPoissonTolerance = 1e-3; // 0.333 is meant as 1/3, 0.33 need not be

const char* name_of(int dim, Plane plane)
{
  if (dim == 3) return "three dimensions";
  return plane == Plane::stress ? "plane stress" : "plane strain";
}

void require_positive(double value, const char* what)
{
  if (!(value > 0.0))
    throw UserError(fmt::format("bond-based peridynamics: {} is {:g}; it must be above 0", what, value));
}

/// Uniform micromodulus times the horizon to its power and, in 2-D, the thickness.
double uniform_factor(int dim, const Elastic& elastic)
{
  if (dim == 3) return 12.0 * elastic.young / std::numbers::pi;
  return (elastic.plane == Plane::stress ? 9.0 : 48.0 / 5.0) * elastic.young / std::numbers::pi;
}
} // namespace

double required_poisson(int dim, Plane plane) { return dim == 2 && plane == Plane::stress ? 1.0 / 3.0 : 0.25; }

template <int Dim>
BondLaw<Dim>::BondLaw(Micromodulus micromodulus, const Elastic& elastic, double horizon)
    : micromodulus_(micromodulus), elastic_(elastic), horizon_(horizon), c0_(0.0)
{
  require_positive(elastic.young, "Young's modulus [Pa]");
  require_positive(horizon, "the horizon [m]");
  if (Dim == 2) require_positive(elastic.thickness, "the thickness [m]");
  const double required = required_poisson(Dim, elastic.plane);
  if (!(std::abs(elastic.poisson - required) <= kPoissonTolerance))
    throw UserError(
        fmt::format("Poisson's ratio {:g} cannot be had from bond-based peridynamics: central pair forces have "
                    "one elastic constant (a Cauchy solid), which fixes it at {:.6g} in {}; use that value",
                    elastic.poisson, required, name_of(Dim, elastic.plane)));
  elastic_.poisson = required;
  const double uniform =
      uniform_factor(Dim, elastic) / (Dim == 2 ? elastic.thickness * std::pow(horizon, 3) : std::pow(horizon, 4));
  c0_ = micromodulus == Micromodulus::uniform ? uniform : (Dim + 2) * uniform;
}

template <int Dim> double BondLaw<Dim>::constant(double xi) const
{
  if (micromodulus_ == Micromodulus::uniform) return c0_;
  return c0_ * std::max(0.0, 1.0 - xi / horizon_);
}

template <int Dim> double BondLaw<Dim>::critical_stretch(double toughness) const
{
  constexpr int power = Dim + 1; // of xi under the integral; conical: 1/(p+1) - 1/(p+2)
  const double shape = micromodulus_ == Micromodulus::uniform ? 1.0 / (power + 1) : 1.0 / ((power + 1) * (power + 2));
  const double front = Dim == 2 ? elastic_.thickness : std::numbers::pi / 2.0;
  return std::sqrt(toughness / (front * c0_ * shape * std::pow(horizon_, power + 1)));
}

template class BondLaw<2>;
template class BondLaw<3>;
} // namespace pdx::law
