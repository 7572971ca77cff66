#include "pdx/xfem/enriched_kernel.hpp"

#include "pdx/fem/elastic_kernel.hpp"

namespace pdx::xfem {
SideMap side_map(const EnrichedElement& element, Side side)
{
  SideMap map = SideMap::Zero(8, element.unknowns());
  map.leftCols<8>().setIdentity();
  int column = 8;
  for (int a = 0; a < 4; ++a) {
    const auto corner = static_cast<std::size_t>(a);
    if (!element.enriched[corner]) continue;
    map.block<2, 2>(2 * a, column) = element.factor(corner, side) * Tensor<2>::Identity();
    column += 2;
  }
  return map;
}

EnrichedVector enriched_force(const EnrichedElement& element, const EnrichedVector& displacement,
                              const law::Elastic& law, law::Kinematics kinematics)
{
  EnrichedVector force = EnrichedVector::Zero(element.unknowns());
  for (const Side side : kSides) {
    const SideMap map = side_map(element, side);
    force.noalias() +=
        map.transpose() * fem::part_force(element.cell.points(side), map * displacement, law, kinematics);
  }
  return force;
}

EnrichedMatrix enriched_tangent(const EnrichedElement& element, const EnrichedVector& displacement,
                                const law::Elastic& law, law::Kinematics kinematics)
{
  EnrichedMatrix tangent = EnrichedMatrix::Zero(element.unknowns(), element.unknowns());
  for (const Side side : kSides) {
    const SideMap map = side_map(element, side);
    const fem::ElementMatrix part = fem::part_tangent(element.cell.points(side), map * displacement, law, kinematics);
    tangent.noalias() += map.transpose() * (part * map).eval();
  }
  return tangent;
}

double enriched_energy(const EnrichedElement& element, const EnrichedVector& displacement, const law::Elastic& law,
                       law::Kinematics kinematics)
{
  double energy = 0.0;
  for (const Side side : kSides)
    energy += fem::part_energy(element.cell.points(side), side_map(element, side) * displacement, law, kinematics);
  return energy;
}
} // namespace pdx::xfem
