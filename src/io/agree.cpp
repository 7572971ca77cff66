#include "pdx/io/agree.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/machine_failure.hpp"
#include "pdx/io/disk_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace pdx::io {
namespace {
// What may be wrong with a path that somebody made up.
constexpr std::array kPathFaults{ENOENT, EACCES, EPERM, ENOTDIR, EISDIR, EEXIST, ENAMETOOLONG, ELOOP, EINVAL, ENXIO};

int rank_in(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
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

Fault disk_fault(const std::string& what, const std::filesystem::path& path, int code)
{
  return {code ? what + " '" + path.string() + "': " + std::strerror(code) : "", true};
}

Fault path_fault(const std::string& what, const std::filesystem::path& path, int code)
{
  return {disk_fault(what, path, code).text, std::ranges::find(kPathFaults, code) == kPathFaults.end()};
}

void settle(MPI_Comm comm, const Fault& mine)
{
  const std::string first = first_message(comm, mine ? (mine.machine ? "m" : "u") + mine.text : "");
  if (first.empty()) return;
  if (first[0] == 'u') throw UserError(first.substr(1));
  throw MachineFailure(first.substr(1));
}

void create_directory(MPI_Comm comm, const std::filesystem::path& directory)
{
  std::error_code error;
  if (rank_in(comm) == 0 && !directory.empty()) std::filesystem::create_directories(directory, error);
  settle(comm, path_fault("cannot create the directory", directory, error.value()));
}

Fault replace_file_alone(const std::filesystem::path& path, std::string_view text)
{
  const std::filesystem::path part = path.string() + ".part";
  DiskFile file;
  int code = file.open(part, O_WRONLY | O_CREAT | O_TRUNC);
  if (!code) code = file.write(std::as_bytes(std::span(text)), 0);
  if (!code) code = file.sync();
  if (const int at_end = file.close(); !code) code = at_end;
  if (!code) code = rename_on_disk(part, path);
  if (code) (void)unlink(part.c_str());
  return disk_fault("cannot write", path, code);
}

void replace_file(MPI_Comm comm, const std::filesystem::path& path, std::string_view text)
{
  settle(comm, rank_in(comm) == 0 ? replace_file_alone(path, text) : Fault{});
}

void rename_durably(MPI_Comm comm, const std::filesystem::path& from, const std::filesystem::path& to)
{
  MPI_Barrier(comm);
  settle(comm, rank_in(comm) == 0 ? disk_fault("cannot write", to, rename_on_disk(from, to)) : Fault{});
}
} // namespace pdx::io
