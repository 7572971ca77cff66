#pragma once
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/scene.hpp"

namespace pdx::scene {
/// Bodies of material points on a grid that is fixed in space and made anew each step, as a scene in time: its rows are
/// the points themselves, wherever they go on the rank that they were dealt to.
SceneMaker grid_scene(MPI_Comm comm, options::SceneOptions& options);

} // namespace pdx::scene
