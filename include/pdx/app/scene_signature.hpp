#pragma once
#include <mpi.h>
#include <string>

namespace pdx::app {
/// All options read so far that make a scene what it is, given or not, "-name = value" a line: every one but those that
/// a run may change as it goes on, of which there is a list. Values are compared as numbers, files by what is in them.
/// Collective.
std::string scene_signature(MPI_Comm comm);
} // namespace pdx::app
