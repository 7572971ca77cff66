#include "pdx/io/disk_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace pdx::io {
namespace {
constexpr std::size_t kMostBytes = std::size_t{1} << 30; // of one call

struct stat status_of(int file)
{
  struct stat status {};
  if (fstat(file, &status) != 0) return {};
  return status;
}

/// Calls move(pointer, bytes, place), which may do a part only, until all is done; 0 or what went wrong.
template <class Byte, class Move> int in_pieces(std::span<Byte> bytes, std::uint64_t at, Move&& move)
{
  while (!bytes.empty()) {
    const ssize_t done = move(bytes.data(), std::min(bytes.size(), kMostBytes), static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return done < 0 ? errno : EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    at += static_cast<std::uint64_t>(done);
  }
  return 0;
}

/// Some file systems have no fsync for what was opened.
bool cannot_sync(int code) { return code == EINVAL || code == ENOTSUP || code == ENOSYS; }
} // namespace

/// A pipe that nobody reads fails instead of waiting.
int DiskFile::open(const std::filesystem::path& path, int flags)
{
  (void)close();
  do file_ = ::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK, 0666);
  while (file_ < 0 && errno == EINTR);
  return file_ < 0 ? errno : 0;
}

int DiskFile::write(std::span<const std::byte> bytes, std::uint64_t at)
{
  return in_pieces(bytes, at, [this](auto... what) { return pwrite(file_, what...); });
}

int DiskFile::append(std::span<const std::byte> bytes)
{
  const std::uint64_t end = size();
  const int code = write(bytes, end);
  if (code && is_regular()) (void)!ftruncate(file_, static_cast<off_t>(end));
  return code;
}

int DiskFile::read(std::span<std::byte> bytes, std::uint64_t at) const
{
  return in_pieces(bytes, at, [this](auto... what) { return pread(file_, what...); });
}

int DiskFile::extend(std::uint64_t to)
{
  return size() >= to || ftruncate(file_, static_cast<off_t>(to)) == 0 ? 0 : errno;
}

int DiskFile::cut(std::uint64_t to)
{
  return size() <= to || ftruncate(file_, static_cast<off_t>(to)) == 0 ? 0 : errno;
}

int DiskFile::sync() { return fsync(file_) == 0 || cannot_sync(errno) ? 0 : errno; }

int DiskFile::close()
{
  const int file = std::exchange(file_, -1);
  return file < 0 || ::close(file) == 0 || errno == EINTR ? 0 : errno;
}

bool DiskFile::is_regular() const { return S_ISREG(status_of(file_).st_mode); }
bool DiskFile::is_linked() const { return status_of(file_).st_nlink > 0; }
std::uint64_t DiskFile::size() const { return static_cast<std::uint64_t>(status_of(file_).st_size); }

int rename_on_disk(const std::filesystem::path& from, const std::filesystem::path& to)
{
  if (std::rename(from.c_str(), to.c_str()) != 0) return errno;
  DiskFile directory;
  if (directory.open(to.has_parent_path() ? to.parent_path() : std::filesystem::path("."), O_RDONLY) == 0)
    (void)directory.sync(); // some file systems have no such thing
  return 0;
}
} // namespace pdx::io
