#pragma once
#include "pdx/law/solid_law.hpp"
#include "pdx/mpm/body_material.hpp"
#include "pdx/mpm/cell_shape.hpp"

#include <array>

namespace pdx::mpm {
/// Displacement of the corners, or what belongs to it: component d of corner I at I * Dim + d.
template <int Dim> using CellVector = Eigen::Matrix<double, kCorners<Dim> * Dim, 1>;
template <int Dim> using CellMatrix = Eigen::Matrix<double, kCorners<Dim> * Dim, kCorners<Dim> * Dim, Eigen::RowMajor>;

/// What cells of a body have in common that have points on the same sites.
///
/// Hourglass control. Fewer points than a cell has modes leave some without stiffness: one point in the plane, one, two
/// or four in a plane of three in space, and so on; which, the rank of the stiffness says. Such cells get
/// 1/2 kappa |sum_I s_I u_I|^2 for each sign pattern s of `hourglass_sign` (after Flanagan and Belytschko, 1981): s is
/// blind to linear displacements, so that uniform strain feels none of it, and a square of a length is blind to
/// rotations, so that it may act on whole displacements: angular momentum stays. kappa is E t / 12 in the plane and
/// E h / 48 in space, what makes a square or cube bend as a beam does, times the part of the cell that has points;
/// E h / 144 for xyz. Full cells of more than one point need none.
template <int Dim> struct CellPoints {
  std::uint64_t mask = 0;
  std::vector<int> sites;                               ///< of the points, rising
  std::vector<CornerValues<Dim>> values;                ///< per point [-]
  std::vector<CornerGradients<Dim>> gradients;          ///< per point [1/m]
  CornerValues<Dim> shares = CornerValues<Dim>::Zero(); ///< volume of the points by N_I [m^3]
  double volume = 0.0;                                  ///< of one point [m^3]
  std::array<double, kHourglasses<Dim>> hourglass{};    ///< kappa [N/m]
  bool held = false;                                    ///< there is hourglass control

  CellPoints(const BodyMaterial& body, std::uint64_t mask);
};

/// d P / d F of a body's law [Pa].
template <int Dim> law::Tangent<Dim> law_tangent(const BodyMaterial& body, const Tensor<Dim>& h);
template <int Dim> double law_energy(const BodyMaterial& body, const Tensor<Dim>& h);      ///< [J/m^3]
template <int Dim> Tensor<Dim> law_stress(const BodyMaterial& body, const Tensor<Dim>& h); ///< first Piola [Pa]

/// Displacement gradient at point p of `points`.
template <int Dim> Tensor<Dim> point_gradient(const CellPoints<Dim>& points, std::size_t p, const CellVector<Dim>& u)
{
  const auto by_corner = Eigen::Map<const Eigen::Matrix<double, Dim, kCorners<Dim>>>(u.data());
  return by_corner * points.gradients[p];
}
/// Tangent of a cell at a displacement of its corners [N/m].
template <int Dim>
CellMatrix<Dim> cell_tangent(const BodyMaterial& body, const CellPoints<Dim>& points, const CellVector<Dim>& u);
} // namespace pdx::mpm
