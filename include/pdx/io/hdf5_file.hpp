#pragma once
#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <mpi.h>
#include <span>
#include <string>
#include <string_view>

namespace pdx::io {
/// One HDF5 file written by all ranks of a communicator together. Every member is collective, with the same names
/// and values on every rank (slabs differ). A write that fails on any rank throws SolverFailure on all of them.
class Hdf5File {
public:
  enum class Mode { create, append };
  /// Creates the file, emptying an existing one, or opens one to add to it. Throws UserError on every rank if it
  /// cannot.
  Hdf5File(MPI_Comm comm, std::filesystem::path path, Mode mode = Mode::create);
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  /// Creates a group and, where missing, its parents: "/step000000/mesh".
  void group(const std::string& path);
  /// Writes [rows of all ranks x components], rank after rank; parents are created where missing.
  /// @param slab this rank's rows x components; may be empty
  void dataset(const std::string& path, std::span<const double> slab, int components);
  void dataset(const std::string& path, std::span<const int> slab, int components); ///< 32-bit integers
  void dataset(const std::string& path, std::span<const std::uint64_t> slab, int components);
  /// Attaches a value to an existing group or dataset ("/" is the file itself).
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, int value);
  void attribute(const std::string& object, const std::string& name, std::string_view value);
  /// Hands everything to the operating system: what was written so far survives a killed run.
  void flush();
  /// The end; nothing may follow. Tells what the destructor would swallow.
  void close();

private:
  struct Types {
    hid_t memory, file;
  };
  void write_slab(const std::string& path, const void* slab, std::size_t rows, int components, Types types);
  void write_attribute(const std::string& object, const std::string& name, const void* value, Types types);
  void agree(bool ok, const std::string& what) const;

  MPI_Comm comm_;
  std::filesystem::path path_;
  hid_t file_ = H5I_INVALID_HID;
};
} // namespace pdx::io
