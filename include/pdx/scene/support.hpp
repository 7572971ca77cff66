#pragma once
#include "pdx/couple/loose_parts.hpp"
#include "pdx/geom/frame.hpp"

namespace pdx::scene {
/// Throws UserError if a part of the body can move rigidly. Collective.   @param frame of places in messages
void require_support(const couple::LooseParts& parts, const geom::Frame& frame);
/// The same while bonds break; unloaded parts of at most `debris` particles may come off. Collective.
void require_support_after_breaking(const couple::LooseParts& parts, Index debris, const geom::Frame& frame);
} // namespace pdx::scene
