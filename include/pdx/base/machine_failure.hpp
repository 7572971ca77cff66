#pragma once
#include <stdexcept>

namespace pdx {
/// The machine failed: a disk, memory, a lost rank; what() is one line that names the file or the memory and the cause.
/// Thrown by every rank alike where ranks can still agree, else by the one it met. Exit status 3.
struct MachineFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};
} // namespace pdx
