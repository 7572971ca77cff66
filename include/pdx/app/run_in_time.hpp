#pragma once
#include "pdx/record/run_files.hpp"
#include "pdx/scene/scene.hpp"

namespace pdx::app {
/// Steps a scene through time and writes what was asked for. Collective.
/// @param make the scene, anew for each layout
void run_in_time(record::RunFiles& files, const scene::SceneMaker& make);
} // namespace pdx::app
