#pragma once

namespace pdx::track {
/// What tells where a crack runs in a cell and where it ends.
enum class Tracker {
  sides,    ///< the line with the best margin between the bodies beside it, and where half of what crosses is broken
  laplacian ///< where the Laplacian of damage is below zero, and where that ends [XPD2 Eq. 9]
};
} // namespace pdx::track
