#pragma once
#include "pdx/io/agree.hpp"
#include "pdx/io/hdf5_journal.hpp"
#include "pdx/io/seal.hpp"

#include <array>
#include <memory>

namespace pdx::io {
/// What HDF5 says about its last failed call.
std::string hdf5_reason();

/// One HDF5 file written by all ranks of a communicator together. Every member is collective, with the same names
/// and values on every rank (slabs differ). Rank 0 alone keeps HDF5's side, in a journal; values go from every rank to
/// their place in the file. What goes wrong on any rank throws MachineFailure on all of them, at the latest from
/// `flush` and `close`; what the file held at the last flush is still there then.
class Hdf5File {
public:
  enum class Mode { create, append, sealed };
  /// Creates the file, emptying an existing one, or opens one to add to it. A sealed one is whole only after `close`.
  /// Throws UserError for a path that cannot be, MachineFailure for a disk that fails.
  Hdf5File(MPI_Comm comm, std::filesystem::path path, Mode mode = Mode::create);
  ~Hdf5File(); ///< what was not flushed or closed is lost
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;
  MPI_Comm comm() const { return comm_; }

  /// Creates a group and, where missing, its parents: "/step000000/mesh".
  void group(const std::string& path);
  /// Writes [rows of all ranks x components], rank after rank; parents are created where missing.
  /// @param slab this rank's rows x components; may be empty
  void dataset(const std::string& path, std::span<const double> slab, int components);
  void dataset(const std::string& path, std::span<const int> slab, int components); ///< 32-bit integers
  void dataset(const std::string& path, std::span<const std::uint64_t> slab, int components);
  /// Another name for what stands at `from`; nothing is copied.
  void link(const std::string& from, const std::string& path);
  /// A text as a table of bytes; rank 0's counts.
  void text(const std::string& path, std::string_view text);
  /// Attaches a value to an existing group or dataset ("/" is the file itself).
  void attribute(const std::string& object, const std::string& name, double value);
  void attribute(const std::string& object, const std::string& name, int value);
  void attribute(const std::string& object, const std::string& name, std::string_view value);
  /// Hands everything to the operating system: what was written so far survives a killed run.
  void flush();
  /// The end; nothing but another `close` may follow. All is on the disk itself then.
  void close();

private:
  struct Type {
    hid_t memory, file;
    const char* name;
    std::size_t bytes;
  };
  void write_slab(const std::string& path, std::span<const std::byte> slab, int components, const Type& type);
  void write_attribute(const std::string& object, const std::string& name, const void* value, const Type& type);
  std::uint64_t make_dataset(const std::string& path, std::array<hsize_t, 2> extent, const Type& type);
  void write_seal();
  void note(int code);                              ///< a failed call on the disk
  void note_hdf5(bool ok, const std::string& what); ///< one of HDF5
  void settle_all();

  MPI_Comm comm_;
  int rank_ = 0;
  std::filesystem::path path_;
  bool sealed_, closed_ = false;
  DiskFile disk_;
  std::unique_ptr<Hdf5Journal> journal_; // on rank 0
  hid_t file_ = H5I_INVALID_HID;         // likewise
  Fault fault_;                          // the first one here that not all ranks know of
  Seal seal_;                            // tables on rank 0, what this rank has written on each
};
} // namespace pdx::io
