#pragma once
#include "pdx/mesh/build.hpp"

namespace pdx::mesh {
/// Corners, counter-clockwise, of the cells that a mesh will have in or beside a box [m]; alike on every rank, in the
/// order of natural numbers. A mesh file is loaded. Collective.
std::vector<std::array<Vector<2>, 4>> cells_near(MPI_Comm comm, const MeshOptions& options, const geom::Box<2>& box);
} // namespace pdx::mesh
