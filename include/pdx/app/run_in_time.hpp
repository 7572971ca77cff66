#pragma once
#include "pdx/app/scene.hpp"

namespace pdx::app {
/// Steps a scene through time and writes what was asked for. Collective.
/// @param make the scene, anew for each layout
void run_in_time(RunFiles& files, const SceneMaker& make);
} // namespace pdx::app
