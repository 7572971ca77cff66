#pragma once
#include "pdx/scene/discretisation.hpp"
#include "pdx/solve/static_driver.hpp"

namespace pdx::scene {
/// Matrix-free unless the user asks for an assembled matrix, by name or by choosing a preconditioner that needs one.
/// Throws UserError for a preconditioner that cannot be.
bool wants_assembled(const options::SceneOptions& options);

/// How a scene is solved for its loads: all but what is done beside. @param options, d outlive the result
solve::StaticOptions static_options(const options::SceneOptions& options, const Discretisation& d, bool assembled);
} // namespace pdx::scene
