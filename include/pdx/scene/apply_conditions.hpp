#pragma once
#include "pdx/scene/discretisation.hpp"

namespace pdx::scene {
/// Turns the boundary conditions into prescribed components and loads of `d.system`. Call before System::bind.
/// Throws UserError for an unknown boundary or a place that selects nothing. Collective.
void apply_conditions(const mesh::Mesh& mesh, const options::SceneOptions& options, const PatchPlan& plan,
                      Discretisation& d);
} // namespace pdx::scene
