#pragma once
#include "pdx/mesh/mesh.hpp"

namespace pdx::mesh {
/// Gives halo vertices their owners' values: `components` entries per local vertex, owned ones first. Collective.
inline void fill_halo(const Mesh& mesh, MPI_Datatype type, int components, void* values)
{
  if (!mesh.vertex_sf()) return;
  MPI_Datatype block = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(components, type, &block);
  MPI_Type_commit(&block);
  PDX_CALL(PetscSFBcastBegin(mesh.vertex_sf(), block, values, values, MPI_REPLACE));
  PDX_CALL(PetscSFBcastEnd(mesh.vertex_sf(), block, values, values, MPI_REPLACE));
  MPI_Type_free(&block);
}
} // namespace pdx::mesh
