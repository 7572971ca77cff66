#pragma once
#include "pdx/base/options.hpp"
#include "pdx/mesh/mesh.hpp"

#include <functional>
#include <memory>
#include <petscpartitioner.h>

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

/// Makes the mesh, cuts it with the chosen PetscPartitioner (METIS or straight lines by default) and flattens it.
/// Collective. Throws UserError, alike on every rank, for a missing or broken file, triangles, or zero cells.
Mesh build(MPI_Comm comm, const MeshOptions& options, const CellCost& cost);

/// Costs of the cells as they were measured, above 0, by natural number; on rank 0 only.
struct MeasuredCosts {
  std::vector<int> of_cell;
};
/// The same mesh cut anew by measured costs, by METIS or along lines whatever cut it at first. Collective.
Mesh build_by_costs(MPI_Comm comm, const MeshOptions& options, const MeasuredCosts& costs);

/// Registers the PetscPartitioner types "metis", "straight" (recursive bisection along lines) and "auto": of these two
/// the one that costs the busiest rank less (idempotent). The last two know where cells are by `note_middles`, and are
/// METIS without. Collective.
void register_partitioners();

/// Tells a partitioner where the cells of its graph are, in its order; on rank 0 all of them.
/// @param middles outlives the partition [m]
void note_middles(PetscPartitioner partitioner, const std::vector<Vector<2>>& middles);
} // namespace pdx::mesh
