#include "pdx/io/agree.hpp"

#include "pdx/base/error.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <unistd.h>

namespace pdx::io {
namespace {
int rank_in(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// Why the file could not be replaced, "" if it was.
std::string try_replace(const std::filesystem::path& path, std::string_view text)
{
  const std::filesystem::path temporary = path.string() + ".part";
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (!file) return "cannot write '" + temporary.string() + "': " + std::strerror(errno);
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  return error ? "cannot write '" + path.string() + "': " + error.message() : "";
}

/// Waits until a file or directory is on the disk; false with errno if it cannot be.
bool sync_path(const std::filesystem::path& path)
{
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool ok = fsync(file) == 0;
  close(file);
  return ok;
}

std::string try_rename(const std::filesystem::path& from, const std::filesystem::path& to)
{
  const std::filesystem::path directory = to.has_parent_path() ? to.parent_path() : std::filesystem::path(".");
  const bool ok = sync_path(from) && std::rename(from.c_str(), to.c_str()) == 0;
  if (!ok) return "cannot write '" + to.string() + "': " + std::strerror(errno);
  (void)sync_path(directory); // some file systems have no such thing
  return "";
}
} // namespace

std::string first_message(MPI_Comm comm, const std::string& mine)
{
  int size = 0;
  MPI_Comm_size(comm, &size);
  const int rank = rank_in(comm);
  int speaker = mine.empty() ? size : rank;
  MPI_Allreduce(MPI_IN_PLACE, &speaker, 1, MPI_INT, MPI_MIN, comm);
  if (speaker == size) return "";
  int length = static_cast<int>(mine.size());
  MPI_Bcast(&length, 1, MPI_INT, speaker, comm);
  std::string message = rank == speaker ? mine : std::string(static_cast<std::size_t>(length), ' ');
  MPI_Bcast(message.data(), length, MPI_CHAR, speaker, comm);
  return message;
}

void create_directory(MPI_Comm comm, const std::filesystem::path& directory)
{
  std::string message;
  if (rank_in(comm) == 0 && !directory.empty()) {
    std::error_code error;
    std::filesystem::create_directories(directory, error);
    if (error) message = "cannot create the directory '" + directory.string() + "': " + error.message();
  }
  message = first_message(comm, message);
  if (!message.empty()) throw UserError(message);
}

void replace_file(MPI_Comm comm, const std::filesystem::path& path, std::string_view text)
{
  const std::string message = first_message(comm, rank_in(comm) == 0 ? try_replace(path, text) : "");
  if (!message.empty()) throw SolverFailure(message);
}

void rename_durably(MPI_Comm comm, const std::filesystem::path& from, const std::filesystem::path& to)
{
  MPI_Barrier(comm);
  const std::string message = first_message(comm, rank_in(comm) == 0 ? try_rename(from, to) : "");
  if (!message.empty()) throw SolverFailure(message);
}
} // namespace pdx::io
