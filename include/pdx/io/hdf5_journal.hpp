#pragma once
#include "pdx/io/disk_file.hpp"

#include <hdf5.h>
#include <map>
#include <vector>

namespace pdx::io {
/// HDF5's own bytes of a file, on one rank. The library writes them into memory, and we put them on the disk: a disk
/// that fails is then nothing HDF5 ever meets, and its objects can be closed at any time. Values of datasets do not
/// come here; ranks write them beside, where HDF5 says they belong.
class Hdf5Journal {
public:
  using Pieces = std::map<std::uint64_t, std::vector<std::byte>>; ///< by place in the file; they do not overlap

  /// @param disk open for what HDF5 reads of an existing file; must outlive this
  explicit Hdf5Journal(const DiskFile& disk) : disk_(disk), end_(disk.size()), old_end_(end_) {}
  ~Hdf5Journal();
  Hdf5Journal(const Hdf5Journal&) = delete;
  Hdf5Journal& operator=(const Hdf5Journal&) = delete;

  /// File access by way of this journal; to be closed by H5Pclose. Below 0 if HDF5 cannot.
  hid_t access();
  const Pieces& pieces() const { return pieces_; }     ///< written and not yet on the disk
  std::uint64_t end() const { return end_; }           ///< of all that HDF5 has given out
  std::uint64_t whole_end() const { return old_end_; } ///< of it when all pieces were on the disk
  /// Puts the pieces on the disk, those behind the old end first: where there is no room for them, what was there is
  /// still whole. 0 or the errno that stopped it.
  int put_on(DiskFile& disk);
  /// The file as HDF5 sees it, zero where nothing was written. 0 or the errno that stopped it.
  int read(std::uint64_t at, std::span<std::byte> bytes) const;

  struct Channel; ///< HDF5's view of this
private:
  friend struct Channel;
  void write(std::uint64_t at, std::span<const std::byte> bytes);

  const DiskFile& disk_;
  Channel* channel_ = nullptr; // while HDF5 has the file open
  Pieces pieces_;
  std::uint64_t end_, old_end_; // now, and when all pieces were on the disk
};
} // namespace pdx::io
