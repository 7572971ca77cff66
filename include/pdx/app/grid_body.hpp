#pragma once
#include "pdx/app/point_body.hpp"
#include "pdx/app/scene.hpp"

namespace pdx::app {
/// Bodies of material points on a grid that is fixed in space and made anew each step, as a scene in time: its rows are
/// the points themselves, wherever they go on the rank that they were dealt to.
SceneMaker grid_scene(MPI_Comm comm, SceneOptions& options);

/// Refuses what has no meaning on such a grid. Throws UserError.
void judge_grid(const SceneOptions& options);
} // namespace pdx::app
