#pragma once
#include "pdx/app/run_files.hpp"

namespace pdx::app {
/// Steps a scene through time and writes what was asked for. Collective.
void run_in_time(RunFiles& files, mesh::Mesh& mesh, const PatchPlan& plan, std::vector<pd::Particle> particles);
/// The same of a solid, from its mesh on. Collective.
void run_solid(RunFiles& files);
/// The same of a cloud, from its file on. Collective.
void run_cloud(RunFiles& files, SceneOptions& options);
} // namespace pdx::app
