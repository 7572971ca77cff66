#pragma once
#include "pdx/io/disk_file.hpp"
#include "pdx/io/seal.hpp"

#include <array>
#include <mpi.h>

namespace pdx::io {
/// A sealed file read by all ranks of a communicator together, without HDF5. Opening it checks every byte against the
/// hashes in it. Every member is collective, with the same names on every rank (slabs differ), and throws UserError on
/// every rank for what is damaged, not there or of another shape.
class SealedReader {
public:
  SealedReader(MPI_Comm comm, std::filesystem::path path);

  bool has(const std::string& name) const { return find(name) != nullptr; }
  std::array<std::int64_t, 2> shape(const std::string& name) const; ///< rows, components
  /// Fills `slab` with rows from `first` on, as many as fit; slabs of ranks may overlap, and be empty.
  void read(const std::string& name, std::int64_t first, int components, std::span<double> slab) const;
  void read(const std::string& name, std::int64_t first, int components, std::span<std::uint64_t> slab) const;
  /// All of a table of one column, on every rank.
  std::vector<double> column(const std::string& name) const;
  std::string text(const std::string& name) const;
  /// Throws UserError on every rank, naming file and table, if `why` is not empty on any. Collective.
  void require(const std::string& name, const std::string& why) const;

private:
  const Seal::Table* find(const std::string& name) const;
  const Seal::Table& table(const std::string& name, std::string_view type) const;
  void read_slab(const Seal::Table& table, std::int64_t first, int components, std::span<std::byte> slab) const;
  void check_bytes() const;

  MPI_Comm comm_;
  std::filesystem::path path_;
  DiskFile disk_;
  Seal seal_;
};
} // namespace pdx::io
