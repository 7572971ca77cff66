#pragma once
#include "pdx/base/petsc.hpp"

#include <type_traits>
#include <vector>

namespace pdx {
/// Everybody's records on every rank, in order of ranks. For short lists only (borders, not areas). Collective.
template <class Record> std::vector<Record> gather_all(MPI_Comm comm, const std::vector<Record>& mine)
{
  static_assert(std::is_trivially_copyable_v<Record>);
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1) return mine;
  std::vector<int> bytes(static_cast<std::size_t>(ranks)), offsets(static_cast<std::size_t>(ranks), 0);
  const int own = static_cast<int>(mine.size() * sizeof(Record));
  MPI_Allgather(&own, 1, MPI_INT, bytes.data(), 1, MPI_INT, comm);
  for (std::size_t r = 1; r < bytes.size(); ++r) offsets[r] = offsets[r - 1] + bytes[r - 1];
  std::vector<Record> all(static_cast<std::size_t>(offsets.back() + bytes.back()) / sizeof(Record));
  MPI_Allgatherv(mine.data(), own, MPI_BYTE, all.data(), bytes.data(), offsets.data(), MPI_BYTE, comm);
  return all;
}

/// True on every rank if it is true on any. Collective.
inline bool any_rank(MPI_Comm comm, bool mine)
{
  int flag = mine;
  MPI_Allreduce(MPI_IN_PLACE, &flag, 1, MPI_INT, MPI_LOR, comm);
  return flag != 0;
}
} // namespace pdx
