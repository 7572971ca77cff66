#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/same_lattice.hpp"
#include "pdx/mpm/grid_cell.hpp"

#include <optional>

namespace pdx::adapt {
/// Which elements are to become particles and which particles elements, alike on every rank. Boxes are elements, or
/// made of whole ones, from the body's corner.
struct LayoutChange {
  struct Cover {
    geom::Box<2> box;     ///< [m]
    double spacing = 0.0; ///< of the particles [m]
    Index body = 0;       ///< that the box is in, as `mesh::Mesh::body`
    geom::LatticeAnchor lattice() const { return {box.lower, spacing}; }
  };
  std::vector<Cover> cover;
  std::vector<geom::Box<2>> uncover; ///< [m]
  /// All cracks as they are to run then, where some were followed further; in their order.
  std::optional<std::vector<crack::Polyline>> cracks;
  /// As far as they are known, through what stays particles too: they hide particles from nodes. Empty: as they are.
  std::vector<crack::Polyline> paths;
  /// In space: cells of the grids of bodies of material points that become particles, ascending.
  std::vector<mpm::GridPlace<3>> cells;
  bool empty() const { return cover.empty() && uncover.empty() && cells.empty(); }
};
} // namespace pdx::adapt
