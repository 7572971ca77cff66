#pragma once
#include <array>
#include <cstdlib>
#include <filesystem>
#include <mpi.h>
#include <string>

namespace pdx::test {
/// A directory of its own under the system's temporary one, the same on every rank, removed at the end. Collective.
class ScratchDirectory {
public:
  explicit ScratchDirectory(MPI_Comm comm) : comm_(comm)
  {
    std::array<char, 256> name{};
    if (first()) {
      std::string pattern = (std::filesystem::temp_directory_path() / "pdx_test_XXXXXX").string();
      if (mkdtemp(pattern.data())) pattern.copy(name.data(), name.size() - 1);
    }
    MPI_Bcast(name.data(), static_cast<int>(name.size()), MPI_CHAR, 0, comm_);
    path_ = name.data();
  }
  ~ScratchDirectory()
  {
    MPI_Barrier(comm_);
    std::error_code ignored;
    if (first() && !path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  const std::filesystem::path& path() const { return path_; }

private:
  bool first() const
  {
    int rank = 0;
    MPI_Comm_rank(comm_, &rank);
    return rank == 0;
  }
  MPI_Comm comm_;
  std::filesystem::path path_;
};
} // namespace pdx::test
