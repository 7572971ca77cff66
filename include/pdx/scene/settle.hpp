#pragma once
#include "pdx/options/scene_options.hpp"

namespace pdx::scene {
/// Moves all coordinates of the options into the frame. Throws UserError where its grid is too coarse.
/// @param finest the smallest length that matters [m]
void move_into(const geom::Frame& frame, double finest, options::SceneOptions& options);

/// Reads the mesh file, if there is one. Returns the shortest side of its elements, or of those of the box; infinite
/// for none [m]. Collective. Throws UserError, alike on every rank.
double read_elements(MPI_Comm comm, mesh::MeshOptions& mesh);

/// Reads the mesh file, if there is one, and moves the scene into the frame of its body. Collective. Throws UserError,
/// alike on every rank, for a bad file and for a body so far out that numbers do not tell its parts apart. Clouds and
/// bodies of points are moved as they are read and filled (`scene_in_time`).
void settle(MPI_Comm comm, options::SceneOptions& options);
} // namespace pdx::scene
