#pragma once
#include "pdx/adapt/layout_change.hpp"
#include "pdx/adapt/scene_view.hpp"

#include <optional>

namespace pdx::adapt {
/// Distances that steer a patch. [m]
struct Reaches {
  double critical = 0.0;  ///< from damage to the interface, below which the patch grows
  double expansion = 0.0; ///< from such damage to a node of an element, below which that becomes particles
};

/// The elements that are to become particles: those with a node nearer than `expansion` to a particle that lost a bond
/// now and is nearer than `critical` to the interface [XPD2 Eqs. 10-14]. Elements that the lattice of the patch does
/// not divide stay, and those next to a patch of another lattice. Alike on every rank, in the order of natural numbers.
/// Collective.
/// @param reaches one per patch   @param news owned particles that lost a bond
/// @param spare_held leaves elements with a held node: particles under a held side are not where the side is, and would
/// be moved there at once
std::vector<LayoutChange::Cover> expansion(const SceneView& scene, std::span<const Reaches> reaches,
                                           std::span<const Index> news, bool spare_held);

/// A particle that a crack has come by, nearer than `critical` to the interface, where no crack that elements have
/// leaves its patch: the first by x and y, nothing where there is none. Alike on every rank. Collective.
std::optional<Vector<2>> broken_at_border(const SceneView& scene, std::span<const Reaches> reaches);

/// Can any element become particles, or is none left? Collective.
bool can_expand(const SceneView& scene);

/// The change that gives the cells with their middle in a box the other use: elements that the first patch's lattice
/// divides become particles where none of the box is, else particles become elements; nothing where no patch would
/// stay. A diagnostic. Collective.
LayoutChange exchanged(const SceneView& scene, const geom::Box<2>& box, bool spare_held);
} // namespace pdx::adapt
