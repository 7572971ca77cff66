#pragma once
#include <functional>
#include <string>

namespace pdx {
/// Does something in a process of its own that may crash or never end: what a library does with a damaged file.
/// "" if it came to its end, else what happened. Nothing it changes is seen here. Call it without MPI in `body`.
/// @param seconds after which it is stopped
std::string try_apart(const std::function<void()>& body, unsigned seconds);
} // namespace pdx
