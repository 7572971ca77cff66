#pragma once
#include "pdx/options/scene_options.hpp"

#include <mpi.h>
#include <string>

namespace pdx::options {
/// What makes a scene this one as far as the options say it, "name = value" a line: material, cracks, zones; then every
/// option read so far, given or not, but those that a run may change as it goes on, of which there is a list. Values
/// are compared as numbers, files by what is in them. Collective.
std::string given_scene(MPI_Comm comm, const SceneOptions& options);
} // namespace pdx::options
