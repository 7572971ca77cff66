#pragma once
#include <Eigen/Core>

namespace pdx::law {
enum class Plane { stress, strain };

/// Isotropic linear elasticity of a plate. In 3-D, c11 and c12 are those of plane strain; `thickness` has no meaning.
struct Elastic {
  double young = 0.0;          ///< E                                             [Pa]
  double poisson = 0.0;        ///< nu, of the solid (not of the plane problem)   [-]
  Plane plane = Plane::stress; ///< which plane problem
  double thickness = 1.0;      ///< out of plane                                  [m]
  double density = 0.0;        ///< rho; 0: statics only                          [kg/m^3]

  /// Second Lame parameter, the shear modulus E / (2 (1 + nu)).                    [Pa]
  double mu() const { return young / (2.0 * (1.0 + poisson)); }
  /// First Lame parameter of the plane problem: sigma_ab = lambda e_cc delta_ab + 2 mu e_ab, c over the plane.
  /// Plane strain: E nu / ((1 + nu)(1 - 2 nu)); plane stress: E nu / (1 - nu^2).   [Pa]
  double lambda() const
  {
    return plane == Plane::strain ? young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
                                  : young * poisson / (1.0 - poisson * poisson);
  }
  double c11() const { return lambda() + 2.0 * mu(); } ///< d sigma_xx / d e_xx     [Pa]
  double c12() const { return lambda(); }              ///< d sigma_xx / d e_yy     [Pa]

  /// Pressure that holds down a free strain in the plane, alike in x and y.        [Pa]
  double swelling_stress(double strain) const { return (c11() + c12()) * strain; }

  /// The larger principal stress from both principal strains.                      [Pa]
  double principal_stress(double larger, double smaller) const
  {
    return lambda() * (larger + smaller) + 2.0 * mu() * larger;
  }

  /// Stress (xx, yy, xy) from strain (xx, yy, gamma_xy = 2 e_xy); not yet times the thickness.   [Pa]
  Eigen::Matrix3d stiffness() const
  {
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    c(0, 0) = c(1, 1) = c11();
    c(0, 1) = c(1, 0) = c12();
    c(2, 2) = mu();
    return c;
  }
};
} // namespace pdx::law
