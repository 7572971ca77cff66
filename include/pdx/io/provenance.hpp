#pragma once
#include <mpi.h>
#include <string>
#include <utility>
#include <vector>

namespace pdx::io {
/// What made a file, by name: pdxsolve's version and commit, compiler and kind of build, PETSc, MPI and HDF5 as they
/// are loaded, host of this rank, number of ranks. No time: equal runs write equal files. Not collective.
std::vector<std::pair<std::string, std::string>> provenance(MPI_Comm comm);
/// How many hosts the ranks are on. Collective.
int host_count(MPI_Comm comm);
} // namespace pdx::io
