#pragma once
#include "pdx/adapt/layout_change.hpp"
#include "pdx/adapt/scene_view.hpp"
#include "pdx/law/elastic.hpp"

#include <functional>
#include <optional>

namespace pdx::adapt {
/// When bulk becomes particles by what it bears, not by what broke [APDMPM Eqs. 26-32].
struct ConversionRule {
  std::optional<double> stress;  ///< largest principal stress [Pa]
  std::optional<double> stretch; ///< largest principal stretch less 1: that of a bond in a uniform strain [-]
  int margin = 2;                ///< cells around one that asks that become particles too
  bool any() const { return stress || stretch; }
};

/// What cells are made of, and the lattice that their particles lie on, by body (`mesh::Mesh::body`).
struct BulkOfBodies {
  std::function<const law::Elastic&(Index body)> elastic;
  std::span<const geom::LatticeAnchor> lattices; ///< where a body has no patch yet
};

/// The cells of elements and material points that are to become particles: those where strain or stress is above the
/// rule's at one of four places, and what lies as near to them in the same body as the margin says. Cells that the
/// lattice does not divide stay, as those next to a patch of another, and those with a held node. Alike on every rank,
/// in the order of natural numbers. Collective.
/// @param local displacement [owned | halo] [m]
std::vector<LayoutChange::Cover> conversion(const SceneView& scene, const ConversionRule& rule,
                                            const BulkOfBodies& bulk, std::span<const double> local);
} // namespace pdx::adapt
