#pragma once
#include <mpi.h>

namespace pdx::app {
/// Reads the given options, solves the scene and writes what was asked for. Collective.
/// @param begin wall clock at the start of the program [s]
/// Throws UserError, SolverFailure or PetscFailure, alike on every rank.
void run(MPI_Comm comm, double begin);
} // namespace pdx::app
