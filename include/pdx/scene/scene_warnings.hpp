#pragma once
#include "pdx/options/scene_options.hpp"
#include "pdx/scene/patches.hpp"

namespace pdx::scene {
/// What is odd but allowed in the options alone, a line each: what acts in time where nothing moves, a scene that
/// nothing loads, components in space that were left out.
std::vector<std::string> option_warnings(const options::SceneOptions& options);

/// Says which crack runs along a row of particles; empty if none does.
std::string row_warning(const options::SceneOptions& options, const PatchPlan& plan);

/// Says that displacements are beyond what small strains mean; empty for a plausible one.
/// @param largest component [m]   @param body the box around it [m]
std::string size_warning(const options::SceneOptions& options, double largest, const geom::Box<2>& body);
} // namespace pdx::scene
