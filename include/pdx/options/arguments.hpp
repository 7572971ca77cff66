#pragma once
#include <mpi.h>
#include <string>

namespace pdx::options {
/// What must be known before PETSc starts.
struct Arguments {
  bool help = false, version = false;
  bool json = false;      ///< help as JSON
  std::string help_words; ///< what is looked for in it, "" for all
  std::string error;      ///< not empty: what is wrong with the options, one line
};

/// Reads the command line, the files it names, PETSc's resource files and PETSC_OPTIONS: all options are in
/// `given_options` then, alike on every rank, for the first one reads. Collective.
Arguments read_arguments(MPI_Comm comm, int argc, char** argv);

/// Puts PETSc's own options into PETSc's store, before it starts. Throws UserError for more than it has room for.
void hand_options_to_petsc();

/// Our version and PETSc's.
std::string version_text();
} // namespace pdx::options
