#pragma once
#include <filesystem>
#include <mpi.h>

namespace pdx::io {
/// Describes the `fields.h5` of a directory for readers of VTKHDF 2.0 (VTK 9.3, ParaView 5.12 and newer): a file
/// `fields_BLOCK.vtkhdf` for each block, an unstructured grid with its steps. Tables are views into fields.h5, which
/// must lie beside; one that several steps share is named once, and tensors come in VTK's order. What was there under
/// these names goes. Throws MachineFailure on every rank if a file cannot be read or written. Collective.
void write_vtkhdf(MPI_Comm comm, const std::filesystem::path& directory);
} // namespace pdx::io
