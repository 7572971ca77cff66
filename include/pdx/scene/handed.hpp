#pragma once
#include "pdx/field/staying_rows.hpp"

#include <cstdint>

namespace pdx::scene {
/// What goes on of a scene's rows when another takes it over as it stands, and what broke at those that do not.
struct Handed {
  field::StayingRows rows;
  std::vector<std::uint64_t> gone; ///< of each particle among those that leave: its bonds, kLatticeWords each
};
} // namespace pdx::scene
