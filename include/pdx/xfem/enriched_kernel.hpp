#pragma once
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/xfem/cut.hpp"

#include <algorithm>

namespace pdx::xfem {
/// A four-node element that one crack cuts. Its unknowns: x and y of corners 1 to 4, then x and y of the enriched sets
/// of its enriched corners, in corner order.
struct EnrichedElement {
  CutCell cell;                   ///< where it is integrated
  std::array<Side, 4> side{};     ///< of each corner: H(x_i)
  std::array<bool, 4> enriched{}; ///< has the corner an enriched set?

  int unknowns() const { return 8 + 2 * static_cast<int>(std::ranges::count(enriched, true)); } ///< 8 to 16
};

/// Displacements [m] or forces [N] of an element's unknowns.
using EnrichedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 16, 1>;
/// Tangent [N/m] in the same order.
using EnrichedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 16, 16>;
/// What corner values of the field on one side an element's unknowns give.
using SideMap = Eigen::Matrix<double, 8, Eigen::Dynamic, Eigen::RowMajor, 8, 16>;

/// On one side of the crack Eq. 12 is a plain bilinear field with the corner values u_i + (H - H_i) a_i: the map from
/// (u, a) to these values. The kernels below sum plain elements over both sides through it [XPD1 Eqs. 12, 13].
inline SideMap side_map(const EnrichedElement& element, Side side)
{
  SideMap map = SideMap::Zero(8, element.unknowns());
  map.leftCols<8>().setIdentity();
  int column = 8;
  for (int a = 0; a < 4; ++a) {
    const auto corner = static_cast<std::size_t>(a);
    if (!element.enriched[corner]) continue;
    map.block<2, 2>(2 * a, column) = shifted_step(side, element.side[corner]) * Tensor<2>::Identity();
    column += 2;
  }
  return map;
}

/// Internal force [N] of all unknowns, the gradient of `enriched_energy`. The crack faces carry nothing.
inline EnrichedVector enriched_force(const EnrichedElement& element, const EnrichedVector& displacement,
                                     const law::Elastic& law, fem::Kinematics kinematics)
{
  EnrichedVector force = EnrichedVector::Zero(element.unknowns());
  for (const Side side : kSides) {
    const SideMap map = side_map(element, side);
    force.noalias() +=
        map.transpose() * fem::part_force(element.cell.points(side), map * displacement, law, kinematics);
  }
  return force;
}

/// Tangent [N/m], the derivative of `enriched_force`; symmetric [XPD1 Eq. 13].
inline EnrichedMatrix enriched_tangent(const EnrichedElement& element, const EnrichedVector& displacement,
                                       const law::Elastic& law, fem::Kinematics kinematics)
{
  EnrichedMatrix tangent = EnrichedMatrix::Zero(element.unknowns(), element.unknowns());
  for (const Side side : kSides) {
    const SideMap map = side_map(element, side);
    const fem::ElementMatrix part = fem::part_tangent(element.cell.points(side), map * displacement, law, kinematics);
    tangent.noalias() += map.transpose() * (part * map).eval();
  }
  return tangent;
}

/// Strain energy [J].
inline double enriched_energy(const EnrichedElement& element, const EnrichedVector& displacement,
                              const law::Elastic& law, fem::Kinematics kinematics)
{
  double energy = 0.0;
  for (const Side side : kSides)
    energy += fem::part_energy(element.cell.points(side), side_map(element, side) * displacement, law, kinematics);
  return energy;
}
} // namespace pdx::xfem
