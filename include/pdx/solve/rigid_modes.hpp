#pragma once
#include "pdx/field/rows.hpp"

namespace pdx::solve {
/// Translations and rotations as near-null space for algebraic multigrid; enriched rows take no part. Collective.
/// @param coordinates of owned rows, dim per row [m]
NullSpaceHandle rigid_modes(const field::Rows& rows, std::span<const double> coordinates);
} // namespace pdx::solve
