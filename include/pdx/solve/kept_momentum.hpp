#pragma once
#include "pdx/solve/moving_system.hpp"

namespace pdx::solve {
/// Nodes and particles that are new share out what is missing of a momentum, as one more velocity of theirs: exactly,
/// whatever they began with. Nothing where none has a mass. Collective.
/// @param is_new  1 or 0 for each owned row; of enriched rows it does not count
/// @param wanted  momentum of all ranks [kg m/s]   @param v owned, two or three components a row [m/s]
void keep_momentum(const MovingSystem& moving, std::span<const double> is_new, const std::array<double, 3>& wanted,
                   std::vector<double>& v);
} // namespace pdx::solve
