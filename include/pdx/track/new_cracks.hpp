#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/track/crack_tree.hpp"

namespace pdx::track {
/// Where cracks began that nobody gave: of damage that hangs together and with no given tip, a start at each piece of
/// the body's border that it reaches, looking inwards; or where it reaches none, at one of its ends. In order of x, y.
/// @param body       its border is the sides of this box [m]
/// @param given      tips that were given: what hangs together with one is no new crack
std::vector<CrackStart> new_starts(std::span<const Arrival> arrivals, std::span<const TreeGround> grounds,
                                   const geom::Box<2>& body, std::span<const CrackStart> given);

/// These cracks as they are now, with paths that begin at their starts: of each start the longest first. A crack that
/// stopped stays. Throws std::logic_error for damage of no ground.
std::vector<GrownTip> new_cracks(std::vector<Arrival> arrivals, std::vector<TreeGround> grounds,
                                 const geom::Box<2>& body, std::span<const CrackStart> given);
} // namespace pdx::track
