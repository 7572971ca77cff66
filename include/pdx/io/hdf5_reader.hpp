#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <mpi.h>
#include <span>
#include <string>

namespace pdx::io {
/// One HDF5 file read by all ranks of a communicator together. Every member is collective, with the same names on every
/// rank (slabs differ), and throws UserError on every rank for what is not there or of another shape.
class Hdf5Reader {
public:
  Hdf5Reader(MPI_Comm comm, std::filesystem::path path);
  ~Hdf5Reader();
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;

  bool has(const std::string& path) const;                          ///< a group or dataset
  std::array<std::int64_t, 2> shape(const std::string& path) const; ///< rows, components
  /// Fills `slab` with rows from `first` on, as many as fit; slabs of ranks may overlap, and be empty.
  void read(const std::string& path, std::int64_t first, int components, std::span<double> slab) const;
  void read(const std::string& path, std::int64_t first, int components, std::span<std::uint64_t> slab) const;
  double real(const std::string& object, const std::string& name) const; ///< an attribute
  int integer(const std::string& object, const std::string& name) const;
  std::string text(const std::string& object, const std::string& name) const;

private:
  void read_slab(const std::string& path, std::array<std::int64_t, 4> slab, void* values, hid_t type) const;
  void read_attribute(const std::string& object, const std::string& name, void* value, hid_t type) const;
  void require(bool ok, const std::string& what) const;

  MPI_Comm comm_;
  std::filesystem::path path_;
  hid_t file_ = H5I_INVALID_HID;
};
} // namespace pdx::io
