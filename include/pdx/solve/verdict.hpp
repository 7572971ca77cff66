#pragma once

namespace pdx::solve {
/// What a driver hears between two steps or loads. relayout: stop here for now; another driver goes on from this state
/// on another layout.
enum class Verdict { go_on, stop, relayout };
} // namespace pdx::solve
