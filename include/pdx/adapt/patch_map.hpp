#pragma once
#include "pdx/adapt/scene_view.hpp"

namespace pdx::adapt {
/// Where the cells of all patches are and what their particles lost, alike on every rank.
struct PatchMap {
  struct Cell {
    Index number; ///< natural
    Index patch;
    geom::Box<2> box; ///< [m]
  };
  struct Damaged {
    Index patch;
    Site<2> site;
    std::array<std::uint64_t, 2> gone; ///< as `pd::LatticePart::gone_of`
    double damage;                     ///< of bonds that broke [-]
    Vector<2> x;                       ///< [m]
  };
  std::vector<Cell> cells;      ///< by number
  std::vector<Damaged> damaged; ///< by patch, then by site: those that lost a bond, to a crack that was given too
};

/// A list of what is in patches, not of the mesh. Collective.
PatchMap map_patches(const SceneView& scene);
} // namespace pdx::adapt
