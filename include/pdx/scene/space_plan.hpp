#pragma once
#include "pdx/couple/space_bonds.hpp"
#include "pdx/scene/point_body.hpp"

#include <set>

namespace pdx::scene {
/// Bodies of material points in space of which cells may be particles: what does not change while these become more.
/// Alike on every rank.
struct SpaceBodies {
  PointPlan<3> points;
  std::vector<geom::SpaceNames> names;          ///< of the lattices of the bodies
  std::vector<std::vector<std::uint8_t>> stays; ///< per body and cell: 0 where particles may take it, else why not
  std::optional<pd::Stencil<3>> stencil;
  std::optional<pd::SolidSides> sides; ///< of the exact surface correction, where it is used

  enum Stays : std::uint8_t { kFree, kNotFull, kOther, kHeld };
  Stays why_stays(const mpm::GridPlace<3>& cell) const;
};

/// Fills the bodies, moves the options into their frame, and says which cells -pd_patches are: `options.pd.cells`.
/// Throws UserError for a box that is not made of whole cells of one body, full of points of the particles' material.
SpaceBodies settle_in_space(options::SceneOptions& options);

/// Where particles are under one layout.
struct SpacePlan {
  std::set<mpm::GridPlace<3>> cells;
  std::vector<couple::SpaceShape> shapes; ///< of the bodies that have some

  /// Throws UserError for cells that cannot be particles.
  SpacePlan(const SpaceBodies& bodies, const std::vector<mpm::GridPlace<3>>& taken);
  /// The particles over the cells of the mesh that this rank owns, by patch and site.
  std::vector<pd::Particle> particles(const SpaceBodies& bodies, const mesh::Mesh& mesh) const;
};
} // namespace pdx::scene
