#include "pdx/io/provenance.hpp"

#include "pdx/base/gather.hpp"
#include "pdx_git_hash.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <hdf5.h>

namespace pdx::io {
namespace {
using HostName = std::array<char, MPI_MAX_PROCESSOR_NAME + 1>;

HostName host_name()
{
  HostName name{};
  int length = 0;
  MPI_Get_processor_name(name.data(), &length);
  return name;
}

std::string petsc_version()
{
  PetscInt major = 0, minor = 0, subminor = 0, release = 0;
  (void)PetscGetVersionNumber(&major, &minor, &subminor, &release);
  return fmt::format("{}.{}.{}", major, minor, subminor);
}

/// The first words of what MPI says of itself, which may be pages.
std::string mpi_version()
{
  std::array<char, MPI_MAX_LIBRARY_VERSION_STRING + 1> text{};
  int length = 0;
  MPI_Get_library_version(text.data(), &length);
  const std::string all = text.data();
  return all.substr(0, std::min(all.find_first_of(",\n"), all.size()));
}

std::string hdf5_version()
{
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}
} // namespace

std::vector<std::pair<std::string, std::string>> provenance(MPI_Comm comm)
{
  int ranks = 0;
  MPI_Comm_size(comm, &ranks);
  return {{"pdxsolve", PDX_VERSION}, {"git", PDX_GIT_HASH},        {"compiler", PDX_COMPILER},
          {"build", PDX_BUILD_TYPE}, {"petsc", petsc_version()},   {"mpi", mpi_version()},
          {"hdf5", hdf5_version()},  {"host", host_name().data()}, {"ranks", fmt::format("{}", ranks)}};
}

int host_count(MPI_Comm comm)
{
  std::vector<HostName> all = gather_all(comm, std::vector<HostName>{host_name()});
  std::ranges::sort(all);
  return static_cast<int>(std::unique(all.begin(), all.end()) - all.begin());
}
} // namespace pdx::io
