#pragma once
#include <string>

namespace pdx {
/// Keeps some memory back for the end of a run that memory runs out of: an allocation that fails gives it free, once,
/// so that there is room to say so and to agree on it, and throws std::bad_alloc.
/// @param when_gone called then
void keep_memory_reserve(void (*when_gone)() noexcept);
/// One line: how much memory this process has and which limit it met.
std::string memory_ran_out();
} // namespace pdx
