#pragma once
#include "pdx/base/petsc.hpp"

#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

namespace pdx {
/// Records that travel between ranks, in order of ranks.
template <class Record> struct Parcels {
  std::vector<Record> records;
  std::vector<int> counts; ///< how many of them go to, or came from, each rank
};

/// Sends every rank what is for it. Collective.
/// @return what came, in order of senders and as each sent it
template <class Record> Parcels<Record> exchange(MPI_Comm comm, const Parcels<Record>& out)
{
  static_assert(std::is_trivially_copyable_v<Record>);
  const std::size_t ranks = out.counts.size();
  if (ranks == 1) return out;
  Parcels<Record> in;
  in.counts.resize(ranks);
  MPI_Alltoall(out.counts.data(), 1, MPI_INT, in.counts.data(), 1, MPI_INT, comm);
  std::vector<int> sent(ranks, 0), come(ranks, 0);
  std::exclusive_scan(out.counts.begin(), out.counts.end(), sent.begin(), 0);
  std::exclusive_scan(in.counts.begin(), in.counts.end(), come.begin(), 0);
  in.records.resize(static_cast<std::size_t>(come.back() + in.counts.back()));
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(static_cast<int>(sizeof(Record)), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Alltoallv(out.records.data(), out.counts.data(), sent.data(), type, in.records.data(), in.counts.data(),
                come.data(), type, comm);
  MPI_Type_free(&type);
  return in;
}

/// Records sorted by the rank they go to, those of one rank in the order given.
/// @param order if not null: place of each sorted record among those given
template <class Record>
Parcels<Record> sort_by_rank(std::span<const Record> records, std::span<const int> rank_of, int ranks,
                             std::vector<std::size_t>* order = nullptr)
{
  Parcels<Record> sorted{std::vector<Record>(records.size()), std::vector<int>(static_cast<std::size_t>(ranks), 0)};
  for (const int r : rank_of) ++sorted.counts[static_cast<std::size_t>(r)];
  std::vector<std::size_t> next(sorted.counts.size(), 0);
  std::exclusive_scan(sorted.counts.begin(), sorted.counts.end(), next.begin(), std::size_t{0});
  if (order) order->resize(records.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    const std::size_t to = next[static_cast<std::size_t>(rank_of[k])]++;
    sorted.records[to] = records[k];
    if (order) (*order)[to] = k;
  }
  return sorted;
}
} // namespace pdx
