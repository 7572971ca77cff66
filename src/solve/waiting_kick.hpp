#pragma once
#include "pdx/solve/central_difference.hpp"

/// The last kick of a step that waits for the first of the next one: both are then one pass over a, v and u, with the
/// same sums, to the last bit.
namespace pdx::solve {
/// From now on the last kick of each step waits. What is prescribed of the velocity has come all the same. Whoever
/// needs v calls `finish_kick` before.
void let_kicks_wait(TS ts);
void finish_kick(TS ts); ///< does nothing where none waits
} // namespace pdx::solve
