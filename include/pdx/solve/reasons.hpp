#pragma once
#include "pdx/base/petsc.hpp"

namespace pdx::solve {
/// Why the last SNESSolve failed and what to try, in words; "" if it converged.
std::string reason_of_failure(SNES snes);
} // namespace pdx::solve
