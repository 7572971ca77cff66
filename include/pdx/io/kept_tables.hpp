#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <mpi.h>
#include <span>
#include <string>

namespace pdx::io {
/// Which tables of a file are what they were when they were last written, on every rank: those need not be written
/// again.
class KeptTables {
public:
  /// Where the file has the values of this name already; `path`, where they are now to be written, if they are others.
  /// Told apart by their hashes of 64 bits. Collective.
  /// @param slab this rank's values
  const std::string& place(MPI_Comm comm, const std::string& name, std::span<const std::byte> slab,
                           const std::string& path);

private:
  struct Kept {
    std::string path;
    std::uint64_t hash = 0;
    std::size_t bytes = 0;
  };
  std::map<std::string, Kept> kept_; // by name
};
} // namespace pdx::io
