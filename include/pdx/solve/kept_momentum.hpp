#pragma once
#include "pdx/solve/moving_system.hpp"

namespace pdx::solve {
/// Nodes and particles that are new share out what is missing of a momentum, as one more velocity of theirs: exactly,
/// whatever they began with. Nothing where none has a mass. Collective.
/// @param is_new  owned rows; enriched ones do not count
/// @param wanted  momentum of all ranks [kg m/s]   @param v owned, two or three components a row [m/s]
void keep_momentum(const MovingSystem& moving, std::span<const Index> is_new, const std::array<double, 3>& wanted,
                   std::span<double> v);

/// About the origin of coordinates, of what has moved, of all ranks; along z alone in the plane [kg m^2/s]. Collective.
/// @param u, v owned, two or three components a row [m], [m/s]
Vector<3> angular_momentum(const MovingSystem& moving, std::span<const double> u, std::span<const double> v);

/// Nodes and particles that are new turn about their centre of mass by what is missing of an angular momentum: the
/// smallest change of velocity, weighed by mass, that keeps momentum and makes no other motion than a turn. Where
/// something is held, and where nothing is new, nothing. Collective.
/// @param wanted as `angular_momentum` of all that was before
void keep_angular_momentum(const MovingSystem& moving, std::span<const Index> is_new, const Vector<3>& wanted,
                           std::span<const double> u, std::span<double> v);
} // namespace pdx::solve
