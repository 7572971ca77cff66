#pragma once
#include "pdx/adapt/layout_change.hpp"
#include "pdx/adapt/scene_view.hpp"
#include "pdx/track/tracker.hpp"

namespace pdx::adapt {
/// May the particles of an owned cell become an element, as far as energy goes? Told the paths of all cracks.
using MayHandBack = std::function<bool(Index cell, const crack::CrackSet& paths)>;

/// Distances that steer what a patch hands back [m], and how its cracks are followed.
struct Retreat {
  double critical = 0.0;    ///< as of `Reaches`: beside what stays damaged behind tips, particles stay too
  double contraction = 0.0; ///< from all tips, beyond which it hands back
  track::Tracker tracker = track::Tracker::sides;
};

/// The elements that patches hand back behind their cracks, and the cracks that those elements carry then [XPD2
/// Eqs. 15-21]. A cell farther than that from all tips of its patch is handed back where the bodies that intact
/// bonds hold together in it and a horizon around it are exactly the sides of the crack's path, and where `may` says
/// so, if it is given. A patch without tip and damage stays as it is, and the last patch does. Alike on every rank.
/// Collective.
/// @param reaches one per patch
LayoutChange contraction(const SceneView& scene, std::span<const Retreat> reaches, const MayHandBack& may);
} // namespace pdx::adapt
