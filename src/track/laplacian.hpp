#pragma once
#include "crack_ahead.hpp"

#include <functional>

namespace pdx::track {
/// Share of the volume in the horizon of a particle that lost bonds took away, cut ones included; 0 without bonds [-].
double damage_at(const BondGraph& graph, const Site<2>& site);
/// Second central differences of damage along x and y, in spacings [XPD2 Eq. 9]; beyond the particles it goes on
/// evenly.
double laplacian_at(const BondGraph& graph, const Site<2>& site);

/// The line along which the Laplacian of damage is below zero in a cell: total least squares of particles, each as
/// heavy as it is low there.
/// @param weight of a place in spacings, besides   @param heading unit vector, the sense of the line
std::optional<Line> ridge_in(const BondGraph& graph, std::span<const Site<2>> sites,
                             const std::function<double(const Vector<2>&)>& weight, const Vector<2>& heading);

/// Where that ends beyond a point: from spacing to spacing along a line through particles of the next horizon, to where
/// the Laplacian is half as low as it was at most. The path is as that of `tip_ahead`.
Ahead ridge_ahead(const BondGraph& graph, const Line& start);
} // namespace pdx::track
