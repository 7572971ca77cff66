#pragma once
#include "pdx/record/run_files.hpp"
#include "pdx/scene/point_plan.hpp"

namespace pdx::app {
/// Solves a scene for all its loads and writes what was asked for. Collective.
/// @param points bodies of material points, settled (`scene::settle_mixed`); null without them
void run_static(record::RunFiles& files, std::shared_ptr<const scene::PointPlan<2>> points = nullptr);
} // namespace pdx::app
