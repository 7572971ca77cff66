#pragma once
#include "pdx/io/disk_file.hpp"

#include <mpi.h>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pdx::io {
/// One column of a curve: what it is and in which unit ("-" for plain numbers).
struct Column {
  std::string name, unit;
};

/// A table that grows row by row: `history.csv`, one row per accepted step, on disk as soon as it is written.
/// Numbers are the shortest that read back to the same double.
class Curve {
public:
  /// Creates the file with its header "name [unit],...". Throws UserError for a path that cannot be, MachineFailure for
  /// a disk that refuses, on every rank. Collective.
  /// @param keep_to goes on with an existing file behind its rows with a first value up to this one: nothing else of it
  ///                is kept. Throws UserError if its columns are others.
  Curve(MPI_Comm comm, std::filesystem::path path, const std::vector<Column>& columns,
        std::optional<double> keep_to = std::nullopt);
  /// Adds a row; rank 0's values count. Throws MachineFailure on every rank if the disk refuses, or
  /// the file was taken away; no half row stays then. Collective.
  /// @param values one per column
  void row(std::span<const double> values);
  /// The end; all rows are on the disk itself then. Throws MachineFailure likewise. Collective.
  void close();

private:
  MPI_Comm comm_;
  std::filesystem::path path_;
  std::size_t columns_;
  DiskFile file_; ///< open on rank 0 only
};
} // namespace pdx::io
