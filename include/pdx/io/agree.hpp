#pragma once
#include <filesystem>
#include <mpi.h>
#include <string>
#include <string_view>

namespace pdx::io {
/// The message of the lowest rank that has one, known to every rank; "" if all is well. Collective.
std::string first_message(MPI_Comm comm, const std::string& mine);

/// Creates the directory and its parents on rank 0. Throws UserError on every rank if it cannot. Collective.
void create_directory(MPI_Comm comm, const std::filesystem::path& directory);

/// Replaces the content of a file in one stroke: rank 0 writes a temporary beside it and renames it, so that a
/// reader (or a killed run) never sees half a file. Throws SolverFailure on every rank if it cannot. Collective.
/// @param text read on rank 0 only
void replace_file(MPI_Comm comm, const std::filesystem::path& path, std::string_view text);
/// Gives a complete file its final name, replacing what had it, once its content is on the disk itself: whatever
/// happens, under `to` there is the old file or the new one. Throws SolverFailure on every rank if it cannot.
/// Collective.
void rename_durably(MPI_Comm comm, const std::filesystem::path& from, const std::filesystem::path& to);
} // namespace pdx::io
