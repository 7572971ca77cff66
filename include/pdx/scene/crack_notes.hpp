#pragma once
#include "pdx/track/crack_tracker.hpp"

namespace pdx::scene {
/// All that a CrackWatch goes on from.
struct CrackNotes {
  std::int64_t bonds_broken = 0; ///< at the last look
  track::CrackTracker::State tracker;
};
} // namespace pdx::scene
