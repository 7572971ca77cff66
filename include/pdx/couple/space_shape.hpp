#pragma once
#include "pdx/geom/site_set.hpp"
#include "pdx/geom/space_names.hpp"
#include "pdx/mpm/body.hpp"
#include "pdx/mpm/grid_cell.hpp"

#include <map>

namespace pdx::couple {
/// Where particles have taken cells of a body of material points in space: all of them are one patch, of any shape, on
/// the lattice of the body's points.
struct SpaceShape {
  const mpm::Body<3>* of = nullptr; ///< outlives this
  Index body = 0;                   ///< its number
  geom::ActiveLattice<3> where;     ///< sites are counted from the body's corner
  geom::SpaceNames names;
  double face_share = 0.0; ///< `couple::face_share`

  /// Is a material point on a site?
  bool has_point(const Site<3>& site) const { return !where.active.has(site) && of->has(site); }
  /// Does a face between particles and points part two sites?
  bool parts(const Site<3>& particle, const Site<3>& point) const
  {
    return where.active.has(particle) && has_point(point);
  }
};

/// Global rows of the nodes of a grid where points meet particles, of all ranks, by place.
using NodeRows = std::map<Site<3>, PetscInt>;
} // namespace pdx::couple
