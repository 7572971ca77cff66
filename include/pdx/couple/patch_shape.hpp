#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/geom/site_names.hpp"
#include "pdx/geom/site_set.hpp"

#include <vector>

namespace pdx::couple {
/// Where one patch lies: boxes that hang together, made of whole cells and of whole lattice cells.
struct PatchShape {
  geom::Box<2> box;                ///< around it [m]
  geom::Lattice<2> lattice;        ///< of that box
  geom::SiteSet<2> active;         ///< the patch's sites
  std::vector<geom::Box<2>> boxes; ///< what it is made of [m]
  geom::SiteNames names;
  Index body = 0; ///< of the mesh (`mesh::Mesh::body`), that it lies in: others may be near

  /// A patch that is one box.
  static PatchShape of_box(const geom::Box<2>& box, const geom::Lattice<2>& lattice);
  /// Is x in one of its boxes, or no further away than the margin [m]?
  bool holds(const Vector<2>& x, double margin = 0.0) const;
  /// Where the lattice line before the sites k of an axis runs [m].
  double line(std::size_t axis, Index k) const;
};
} // namespace pdx::couple
