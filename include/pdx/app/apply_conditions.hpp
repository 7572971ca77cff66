#pragma once
#include "pdx/app/discretisation.hpp"

namespace pdx::app {
/// Turns the boundary conditions into prescribed components and loads of `d.system`. Call before System::bind.
/// Throws UserError for an unknown boundary, a place that selects nothing, or a body that can still move rigidly.
/// Collective.
void apply_conditions(const mesh::Mesh& mesh, const SceneOptions& options, const PatchPlan& plan, Discretisation& d);

/// Throws UserError if the prescribed components leave a rigid motion free. Collective.
void require_support(const field::System& system);
} // namespace pdx::app
