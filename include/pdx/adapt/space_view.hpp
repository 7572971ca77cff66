#pragma once
#include "pdx/couple/fracture.hpp"
#include "pdx/couple/space_bonds.hpp"
#include "pdx/pd/particles.hpp"

#include <functional>

namespace pdx::adapt {
/// What of a scene in space is looked at to make particles of its material points; lent for one call.
struct SpaceView {
  const field::RowHalo& halo;
  std::span<const mpm::Body<3>> bodies;
  std::span<const geom::SpaceNames> names;    ///< of the bodies' lattices
  std::span<const mpm::GridCell<3>> cells;    ///< owned, with points
  std::span<const mpm::GridPlace<3>> nodes;   ///< of owned rows, in order
  std::span<const couple::SpaceShape> shapes; ///< where particles are, one per patch
  std::span<const pd::Particle> particles;    ///< owned, in order of rows
  const pd::BondTerm<3>& bonds;
  const couple::CarriedBonds<3>* carried; ///< null without an interface
  /// Is it a cell full of points that may become particles? Alike on every rank.
  std::function<bool(const mpm::GridPlace<3>&)> may_convert;
};
} // namespace pdx::adapt
