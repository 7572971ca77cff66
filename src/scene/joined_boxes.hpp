#pragma once
#include "pdx/scene/patches.hpp"

namespace pdx::scene {
constexpr double kFits = 1e-6; ///< how far a side may be from a whole number of spacings [spacings]

/// Which boxes of -pd_patches hang together, by their numbers: those that overlap, or share an edge or a corner.
/// Patches and their boxes come in the order in which they were given. Throws UserError where such boxes have no
/// lattice in common, saying what would fit.
std::vector<std::vector<std::size_t>> patches_of_boxes(const options::SceneOptions& options);

/// The patch that some boxes make up. Throws UserError for a spacing that does not fit.
couple::PatchShape join_boxes(const options::SceneOptions& options, std::span<const std::size_t> entries);

/// Numbers all sites of the body, and a margin around it, by lattice: patches of one spacing and phase show pieces of
/// one lattice. Lattices have the order of `anchors`, or of the patches where there are none.
void name_sites(std::span<couple::PatchShape> shapes, geom::Box<2> body, std::span<const geom::LatticeAnchor> anchors);
} // namespace pdx::scene
