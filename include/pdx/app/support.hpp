#pragma once
#include "pdx/couple/loose_parts.hpp"

namespace pdx::app {
/// Throws UserError if a part of the body can move rigidly. Collective.
void require_support(const couple::LooseParts& parts);
/// The same while bonds break; unloaded parts of at most `debris` particles may come off. Collective.
void require_support_after_breaking(const couple::LooseParts& parts, Index debris);
} // namespace pdx::app
