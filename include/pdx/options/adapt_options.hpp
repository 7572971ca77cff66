#pragma once
#include "pdx/options/scene_options.hpp"

namespace pdx::options {
constexpr double kSeedShare = 0.25; ///< spacing of seeds where none is given, in sides of an element [-]

/// As given, or by the horizon of the particles and the smallest side of elements there [m].
///@{
double critical_length(const SceneOptions& options, double horizon, double element); ///< how near damage may come
/// How near to damage, or to the tip of a crack that is given, elements become particles.
double expansion_length(const SceneOptions& options, double horizon, double element);
double contraction_length(const SceneOptions& options, double horizon, double element); ///< how far behind all tips
///@}

/// Throws UserError where options ask for what no patch can do.
void judge_adapt(const SceneOptions& options);

/// Throws UserError where `-adapt_seed tip` cannot be, as far as options alone tell.
void judge_seeds(const SceneOptions& options);
} // namespace pdx::options
