#pragma once
#include <cassert>
#include <stdexcept>
#include <string>
namespace pdx {
/// A mistake in the input, thrown by every rank alike; what() is one line that says how to mend it. Exit status 1.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// The solver failed; what() says which step, why and what to try. Exit status 2.
struct SolverFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A PETSc call that failed for a reason that is neither of the above. Exit status 3.
struct PetscFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};
} // namespace pdx
/// An invariant of ours; checked in debug builds only.
#define PDX_ASSERT(condition) assert(condition)
