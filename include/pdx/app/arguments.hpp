#pragma once
#include <string>

namespace pdx::app {
/// What must be known before PETSc starts.
struct Arguments {
  bool help = false, version = false;
  std::string error; ///< not empty: an options file that PETSc could not read
};

/// Takes -help and -version out of the arguments (PETSc would print pages of its own) and checks every -options_file:
/// PETSc meets a bad one before any error handler of ours stands. A bad file is taken out too.
Arguments look_at_arguments(int& argc, char** argv);

/// Prints our version and PETSc's.
void print_version();
} // namespace pdx::app
