#pragma once
#include "pdx/geom/lattice.hpp"
#include "pdx/mesh/locate.hpp"
#include "pdx/mesh/mesh.hpp"

#include <cmath>

namespace pdx::mesh {
/// Calls visit(site, point) for the lattice sites that a local cell holds, x fastest; `band` sites around the lattice
/// are looked at too. Every site in the mesh is held by exactly one cell.
template <class Visit>
void for_each_site(const Mesh& mesh, Index cell, const geom::Lattice<2>& lattice, Index band, Visit&& visit)
{
  const auto corners = mesh.corners(cell);
  const Vector<2> lower = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).cwiseMin(corners[3]);
  const Vector<2> upper = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).cwiseMax(corners[3]);
  Site<2> from{}, to{};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto e = static_cast<Eigen::Index>(d);
    from[d] = std::max(-band, static_cast<Index>(std::floor((lower[e] - lattice.origin[e]) / lattice.dx - 0.51)));
    to[d] = std::min(lattice.count[d] + band - 1,
                     static_cast<Index>(std::ceil((upper[e] - lattice.origin[e]) / lattice.dx - 0.49)));
  }
  std::array<Index, 4> natural{};
  for (std::size_t a = 0; a < 4; ++a) natural[a] = mesh.natural_vertex(mesh.cell(cell)[a]);
  for (Site<2> site{0, from[1]}; site[1] <= to[1]; ++site[1])
    for (site[0] = from[0]; site[0] <= to[0]; ++site[0]) {
      const Vector<2> x = lattice.point(site);
      if (cell_holds(corners, natural, x, 1e-6 * lattice.dx)) visit(std::as_const(site), x);
    }
}
} // namespace pdx::mesh
