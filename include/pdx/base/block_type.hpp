#pragma once
#include <mpi.h>

namespace pdx {
/// So many doubles as one MPI datatype. It is made when first asked for and lives until PetscFinalize: exchanges of
/// every step need not make it anew.
MPI_Datatype block_type(int components);
} // namespace pdx
