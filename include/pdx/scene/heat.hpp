#pragma once
#include "pdx/field/output_field.hpp"
#include "pdx/field/system.hpp"
#include "pdx/options/scene_options.hpp"

#include <memory>

namespace pdx::scene {
/// What the material expands by in the plane for a degree: in plane strain more than alpha, as it is held in the third
/// direction [1/K].
double expansion_in_plane(const options::SceneOptions& options);

/// Free strain from the temperatures of the options along their path of loads, for a body in the scene's frame; null
/// where they name none.
std::unique_ptr<field::Swelling> swelling_of(const options::SceneOptions& options);

/// Adds the temperature at the points of a block, in the degrees of the options, where it is known.
void push_temperature(const options::SceneOptions& options, const field::System& system, field::OutputBlock& block);
} // namespace pdx::scene
