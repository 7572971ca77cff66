#pragma once
#include "pdx/app/discretisation.hpp"

namespace pdx::app {
/// Turns the boundary conditions into prescribed components and loads of `d.system`. Call before System::bind.
/// Throws UserError for an unknown boundary or a place that selects nothing. Collective.
void apply_conditions(const mesh::Mesh& mesh, const SceneOptions& options, const PatchPlan& plan, Discretisation& d);
} // namespace pdx::app
