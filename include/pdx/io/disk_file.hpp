#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace pdx::io {
/// A file of the operating system. Every call is whole or says why not: 0, or the errno that stopped it.
class DiskFile {
public:
  DiskFile() = default;
  ~DiskFile() { (void)close(); }
  DiskFile(const DiskFile&) = delete;
  DiskFile& operator=(const DiskFile&) = delete;

  /// @param flags of open(2)
  int open(const std::filesystem::path& path, int flags);
  int write(std::span<const std::byte> bytes, std::uint64_t at);
  int append(std::span<const std::byte> bytes);                 ///< at the end, all or nothing
  int read(std::span<std::byte> bytes, std::uint64_t at) const; ///< EIO where the file ends before
  int extend(std::uint64_t size);                               ///< to this size at least
  int cut(std::uint64_t size);                                  ///< to this size at most
  int sync();                                                   ///< waits until all is on the disk itself
  int close();
  bool is_open() const { return file_ >= 0; }
  bool is_regular() const;
  bool is_linked() const; ///< still has a name
  std::uint64_t size() const;
  int descriptor() const { return file_; }

private:
  int file_ = -1;
};

/// Why the directory entry could not be put on the disk or renamed; 0 if it was.
int rename_on_disk(const std::filesystem::path& from, const std::filesystem::path& to);
} // namespace pdx::io
