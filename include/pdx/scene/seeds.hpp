#pragma once
#include "pdx/options/scene_options.hpp"

namespace pdx::scene {

/// Puts the patches of `-adapt_seed tip` into settled options, as if they had been given by `-pd_patches`: around each
/// tip of a crack the elements that expansion would take if there were damage. Boxes that overlap are cut apart; those
/// that touch make up one patch. Chooses the spacing where none is given. Collective. Throws UserError, alike on every
/// rank, where no crack has a tip in the body, and for elements at a tip that cannot become particles.
void plant_seeds(MPI_Comm comm, options::SceneOptions& options);

/// Boxes of the patches of a scene as the user would give them, x0,y0,x1,y1 each [m].
std::vector<std::array<double, 4>> given_boxes(const options::SceneOptions& options);
} // namespace pdx::scene
