#pragma once
#include "pdx/base/options.hpp"
#include "pdx/mesh/mesh.hpp"

#include <functional>
#include <memory>

namespace pdx::mesh {
struct CellList;

/// What a user may say about the mesh: `-mesh_lower x,y -mesh_upper x,y -mesh_cells nx,ny` (box), or `-mesh_file`
/// (Gmsh).
struct MeshOptions {
  std::string file;                 ///< -mesh_file    Gmsh file of four-node cells; "" for a box
  geom::Box<2> box;                 ///< -mesh_lower, -mesh_upper; that around a file's cells once it is loaded [m]
  std::array<Index, 2> cells{0, 0}; ///< -mesh_cells   cells per direction of a box; 0,0 if not given
  std::shared_ptr<CellList> list;   ///< of a file that is loaded, on rank 0
  /// Parses; throws UserError for what can never be right, and for no mesh at all if one is needed.
  static MeshOptions read(bool needed = true);
};

/// Reads the file of the options on rank 0; `build` does it otherwise. Returns the length of the shortest edge [m].
/// Collective. Throws UserError, alike on every rank, for a missing or broken file.
double load(MPI_Comm comm, MeshOptions& options);

/// Cost of a cell, from its corners (counter-clockwise), in any unit; must be above 0.
using CellCost = std::function<int(const std::array<Vector<2>, 4>&)>;

/// Makes the mesh, cuts it with the chosen PetscPartitioner (METIS by default) and flattens it. Collective.
/// Throws UserError, alike on every rank, for a missing or broken file, triangles, or zero cells.
Mesh build(MPI_Comm comm, const MeshOptions& options, const CellCost& cost);

/// Costs of the cells as they were measured, above 0, by natural number; on rank 0 only.
struct MeasuredCosts {
  std::vector<int> of_cell;
};
/// The same mesh cut anew by measured costs, by METIS whatever cut it at first. Collective.
Mesh build_by_costs(MPI_Comm comm, const MeshOptions& options, const MeasuredCosts& costs);

/// Registers the PetscPartitioner type "metis" (idempotent). Collective.
void register_metis_partitioner();
} // namespace pdx::mesh
