#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/geom/same_lattice.hpp"

#include <vector>

namespace pdx::adapt {
/// Which elements are to become particles and which particles elements, alike on every rank. Boxes are elements, or
/// made of whole ones, from the body's corner.
struct LayoutChange {
  struct Cover {
    geom::Box<2> box;     ///< [m]
    double spacing = 0.0; ///< of the particles [m]
    geom::LatticeAnchor lattice() const { return {box.lower, spacing}; }
  };
  std::vector<Cover> cover;
  std::vector<geom::Box<2>> uncover; ///< [m]
  bool empty() const { return cover.empty() && uncover.empty(); }
};
} // namespace pdx::adapt
