#pragma once
#include "pdx/law/elastic.hpp"

namespace pdx::law {
/// How the stiffness of a bond depends on its length: the same for all, or falling linearly to 0 at the horizon.
enum class Micromodulus { uniform, conical };

/// The one Poisson's ratio bond-based peridynamics has: 1/3 in plane stress, 1/4 in plane strain and 3-D.   [-]
double required_poisson(int dim, Plane plane);

/// Bonds of the continuous (not yet discretised) bond-based solid.  [XPD1 Eqs. 3, 4], with nu at its required value.
/// XPD1 prints Eq. 3 without nu and Eq. 4 without the thickness; both factors belong in both.
template <int Dim> class BondLaw {
public:
  /// @param horizon delta [m]
  /// Throws UserError if elastic.poisson is further than 1e-3 from `required_poisson`, or if Young's modulus, the
  /// horizon or (2-D) the thickness is not positive. The constants use the required value exactly.
  BondLaw(Micromodulus micromodulus, const Elastic& elastic, double horizon);

  /// Force density per unit stretch c(xi) of bonds of length xi [m]; uniform: 9E/(pi t d^3) in plane stress,
  /// 48E/(5 pi t d^3) in plane strain, 12E/(pi d^4) in 3-D, whatever xi; conical: 4 (2-D) or 5 (3-D) times
  /// that times (1 - xi/d), and 0 beyond the horizon.                              [N/m^6]
  double constant(double xi) const;
  /// Stretch at which bonds break, so that separating a plane costs `toughness` [J/m^2]; from
  /// G = t int_0^d c s0^2 xi^3 (2-D), (pi/2) int_0^d c s0^2 xi^4 (3-D).  [XPD1 Eqs. 6, 7]   [-]
  double critical_stretch(double toughness) const;
  /// The solid the bonds stand for: the elastic constants with the required Poisson's ratio.
  const Elastic& elastic() const { return elastic_; }
  Micromodulus micromodulus() const { return micromodulus_; }
  double horizon() const { return horizon_; } ///< [m]

private:
  Micromodulus micromodulus_;
  Elastic elastic_;
  double horizon_; ///< [m]
  double c0_;      ///< c at xi = 0 [N/m^6]
};
} // namespace pdx::law
