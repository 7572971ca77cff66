#pragma once
#include "pdx/record/run_files.hpp"

namespace pdx::app {
/// Matrix-free unless the user asks for an assembled matrix, by name or by choosing a preconditioner that needs one.
/// Throws UserError for a preconditioner that cannot be.
bool wants_assembled(const options::SceneOptions& options);

/// Solves a scene for all its loads and writes what was asked for. Collective.
void run_static(record::RunFiles& files);
} // namespace pdx::app
