#include "pdx/pd/toughness.hpp"

#include "pdx/base/error.hpp"

#include <cmath>
#include <fmt/format.h>

namespace pdx::pd {
template <int Dim>
double critical_stretch(const Stencil<Dim>& stencil, const law::BondLaw<Dim>& bond, double toughness, Toughness by)
{
  if (!(toughness > 0.0 && std::isfinite(toughness)))
    throw UserError(fmt::format("the energy release rate Gc is {:g} J/m^2; it must be above 0", toughness));
  if (by == Toughness::continuum) return bond.critical_stretch(toughness);
  return std::sqrt(toughness / lattice_toughness(stencil, 1.0));
}
template double critical_stretch<2>(const Stencil<2>&, const law::BondLaw<2>&, double, Toughness);
template double critical_stretch<3>(const Stencil<3>&, const law::BondLaw<3>&, double, Toughness);
} // namespace pdx::pd
