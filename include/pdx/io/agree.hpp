#pragma once
#include <filesystem>
#include <mpi.h>
#include <string>
#include <string_view>

namespace pdx::io {
/// The message of the lowest rank that has one, known to every rank; "" if all is well. Collective.
std::string first_message(MPI_Comm comm, const std::string& mine);

/// Why something could not be done, in one line.
struct Fault {
  std::string text;    ///< empty: all is well
  bool machine = true; ///< disk, memory; else a mistake of the user
  explicit operator bool() const { return !text.empty(); }
};
/// What the operating system says of a file: its errno, none for 0. A file that was there, or should be, is the
/// machine's.
Fault disk_fault(const std::string& what, const std::filesystem::path& path, int code);
/// The same where a path the user gave is made or opened for the first time: a path that cannot be is no failing disk.
Fault path_fault(const std::string& what, const std::filesystem::path& path, int code);
/// Throws the fault of the lowest rank that has one on every rank, as MachineFailure or UserError. Collective.
void settle(MPI_Comm comm, const Fault& mine);

/// Creates the directory and its parents on rank 0. Throws UserError or MachineFailure on every rank if it cannot.
/// Collective.
void create_directory(MPI_Comm comm, const std::filesystem::path& directory);

/// Replaces the content of a file in one stroke: rank 0 writes a temporary beside it and renames it, so that a
/// reader (or a killed run) never sees half a file. Throws MachineFailure on every rank if it cannot. Collective.
/// @param text read on rank 0 only
void replace_file(MPI_Comm comm, const std::filesystem::path& path, std::string_view text);
/// The same by this process alone.
Fault replace_file_alone(const std::filesystem::path& path, std::string_view text);
/// Gives a complete file, which is on the disk itself, its final name, replacing what had it: whatever happens, under
/// `to` there is the old file or the new one. Throws MachineFailure on every rank if it cannot. Collective.
void rename_durably(MPI_Comm comm, const std::filesystem::path& from, const std::filesystem::path& to);
} // namespace pdx::io
