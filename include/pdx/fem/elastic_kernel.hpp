#pragma once
#include "pdx/fem/element.hpp"
#include "pdx/fem/shape.hpp"
#include "pdx/law/elastic.hpp"

#include <cmath>

namespace pdx::fem {
/// Strain at a point of an element and how it varies with the corner displacements.
struct PointStrain {
  Tensor<2> deformation;                 ///< F = I + du/dX; I if small [-]
  Eigen::Vector3d strain;                ///< (xx, yy, 2 xy) [-]
  Eigen::Matrix<double, 3, 8> variation; ///< d strain / d displacement [1/m]
};

/// Small: e = sym(du/dX). Finite: E = (F^T F - I) / 2, from du/dX alone so that small strains keep their digits.
inline PointStrain point_strain(const Gradients& gradients, const ElementVector& displacement, Kinematics kinematics)
{
  const Tensor<2> h = Eigen::Map<const Gradients>(displacement.data()) * gradients.transpose(); // du/dX
  const bool finite = kinematics == Kinematics::finite;
  PointStrain p;
  p.deformation.setIdentity();
  p.strain << h(0, 0), h(1, 1), h(0, 1) + h(1, 0);
  if (finite) {
    p.deformation += h;
    p.strain += Eigen::Vector3d{0.5 * h.col(0).squaredNorm(), 0.5 * h.col(1).squaredNorm(), h.col(0).dot(h.col(1))};
  }
  const Tensor<2>& f = p.deformation;
  for (int a = 0; a < 4; ++a) {
    p.variation.block<1, 2>(0, 2 * a) = gradients(0, a) * f.col(0).transpose();
    p.variation.block<1, 2>(1, 2 * a) = gradients(1, a) * f.col(1).transpose();
    p.variation.block<1, 2>(2, 2 * a) = gradients(1, a) * f.col(0).transpose() + gradients(0, a) * f.col(1).transpose();
  }
  return p;
}

/// Internal force int B^T C E t dA [N], the gradient of `part_energy`.
/// @param points a range of QuadraturePoint (or what derives from it): all of an element, or a part
template <class Points>
ElementVector part_force(const Points& points, const ElementVector& displacement, const law::Elastic& law,
                         Kinematics kinematics)
{
  const Eigen::Matrix3d stiffness = law.stiffness();
  ElementVector force = ElementVector::Zero();
  for (const QuadraturePoint& at : points) {
    const PointStrain p = point_strain(at.gradients, displacement, kinematics);
    const Eigen::Vector3d stress = stiffness * p.strain; // second Piola-Kirchhoff [Pa]
    force.noalias() += at.area * law.thickness * (p.variation.transpose() * stress);
  }
  return force;
}

/// Tangent int (B^T C B + stress part) t dA [N/m], the derivative of `part_force`; symmetric. The stress part is
/// grad N_a . S grad N_b on the diagonal of block (a, b) for finite kinematics, none for small.
template <class Points>
ElementMatrix part_tangent(const Points& points, const ElementVector& displacement, const law::Elastic& law,
                           Kinematics kinematics)
{
  const Eigen::Matrix3d stiffness = law.stiffness();
  ElementMatrix tangent = ElementMatrix::Zero();
  for (const QuadraturePoint& at : points) {
    const PointStrain p = point_strain(at.gradients, displacement, kinematics);
    const double volume = at.area * law.thickness;
    tangent.noalias() += p.variation.transpose() * (volume * stiffness) * p.variation;
    if (kinematics == Kinematics::small) continue;
    const Eigen::Vector3d s = stiffness * p.strain;
    const Eigen::Matrix4d pull =
        volume * (at.gradients.transpose() * Tensor<2>{{s[0], s[2]}, {s[2], s[1]}} * at.gradients);
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b) tangent.block<2, 2>(2 * a, 2 * b).diagonal().array() += pull(a, b);
  }
  return tangent;
}

/// Strain energy int 1/2 E . C E t dA [J].
template <class Points>
double part_energy(const Points& points, const ElementVector& displacement, const law::Elastic& law,
                   Kinematics kinematics)
{
  const Eigen::Matrix3d stiffness = law.stiffness();
  double energy = 0.0;
  for (const QuadraturePoint& at : points) {
    const Eigen::Vector3d strain = point_strain(at.gradients, displacement, kinematics).strain;
    energy += 0.5 * at.area * law.thickness * strain.dot(stiffness * strain);
  }
  return energy;
}

/// The same of a whole element.
inline ElementVector element_force(const Corners& corners, const ElementVector& displacement, const law::Elastic& law,
                                   Kinematics kinematics)
{
  return part_force(gauss_rule(corners), displacement, law, kinematics);
}
inline ElementMatrix element_tangent(const Corners& corners, const ElementVector& displacement, const law::Elastic& law,
                                     Kinematics kinematics)
{
  return part_tangent(gauss_rule(corners), displacement, law, kinematics);
}
inline double element_energy(const Corners& corners, const ElementVector& displacement, const law::Elastic& law,
                             Kinematics kinematics)
{
  return part_energy(gauss_rule(corners), displacement, law, kinematics);
}

/// Areas int N_a dA of the corners, the row sums of int N_a N_b dA [m^2]; exact, equal quarters for parallelograms.
inline Eigen::Vector4d corner_areas(const Corners& corners)
{
  const Gradients points = gauss_points();
  Eigen::Vector4d areas = Eigen::Vector4d::Zero();
  for (int g = 0; g < 4; ++g) areas += map_point(corners, points.col(g)).jacobian * shape(points.col(g));
  return areas;
}

/// Cauchy stress (xx, yy, xy) [Pa] at a point: C e if small, F S F^T / det F if finite. In plane stress det F holds
/// the stretch through the thickness, which the in-plane strain fixes: 1 + 2 E_zz = 1 - 2 nu / (1 - nu) (E_xx + E_yy).
inline Eigen::Vector3d cauchy_stress(const PointStrain& p, const law::Elastic& law, Kinematics kinematics)
{
  const Eigen::Vector3d s = law.stiffness() * p.strain;
  if (kinematics == Kinematics::small) return s;
  double volume = p.deformation.determinant();
  if (law.plane == law::Plane::stress)
    volume *= std::sqrt(1.0 - 2.0 * law.poisson / (1.0 - law.poisson) * (p.strain[0] + p.strain[1]));
  const Tensor<2> sigma = p.deformation * Tensor<2>{{s[0], s[2]}, {s[2], s[1]}} * p.deformation.transpose() / volume;
  return {sigma(0, 0), sigma(1, 1), sigma(0, 1)};
}
} // namespace pdx::fem
