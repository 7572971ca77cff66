#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/box.hpp"

#include <span>

namespace pdx::adapt {
/// A crack that goes on from one of its ends through points; its own stay, of the others those where it bends.
/// @param last from its last point, else from its first   @param ahead in the order in which it runs
crack::Polyline gone_on(crack::Polyline crack, bool last, std::span<const Vector<2>> ahead);

/// From a point to the nearest point of some chains; infinite without any. [m]
double distance(std::span<const crack::Polyline> chains, const Vector<2>& x);
/// From a box to the nearest place of it; 0 inside. [m]
double distance(const geom::Box<2>& box, const Vector<2>& x);
} // namespace pdx::adapt
