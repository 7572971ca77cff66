#include "pdx/pd/site_directory.hpp"

#include "pdx/base/exchange.hpp"
#include "pdx/base/gather.hpp"

namespace pdx::pd {
namespace {
struct SiteRow {
  Index site;
  PetscInt row;
};

int ranks_of(MPI_Comm comm)
{
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}

int rank_of(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// The rank that keeps each site of a table spread evenly.
std::vector<int> keepers_of(std::span<const Index> sites, Index total, int ranks)
{
  std::vector<int> keepers(sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) keepers[k] = static_cast<int>(std::int64_t{sites[k]} * ranks / total);
  return keepers;
}

/// The first site that a rank keeps: the least that `keepers_of` gives to it.
Index first_kept(int rank, Index total, int ranks)
{
  return static_cast<Index>((std::int64_t{rank} * total + ranks - 1) / ranks);
}
} // namespace

SiteDirectory::SiteDirectory(MPI_Comm comm, Index total_sites, std::span<const Index> sites, PetscInt first_row)
    : comm_(comm), total_(total_sites), first_(first_row), count_(static_cast<PetscInt>(sites.size()))
{
  const int ranks = ranks_of(comm);
  const int rank = rank_of(comm);
  const Index first = first_kept(rank, total_, ranks);
  table_.assign(static_cast<std::size_t>(first_kept(rank + 1, total_, ranks) - first), -1);
  std::vector<SiteRow> mine(sites.size());
  for (std::size_t k = 0; k < sites.size(); ++k) mine[k] = {sites[k], first_row + static_cast<PetscInt>(k)};
  const auto sorted = sort_by_rank<SiteRow>(mine, keepers_of(sites, total_, ranks), ranks);
  for (const auto& [site, row] : exchange(comm, sorted).records) table_[static_cast<std::size_t>(site - first)] = row;
}

std::vector<PetscInt> SiteDirectory::rows(std::span<const Index> sites) const
{
  const int ranks = ranks_of(comm_);
  const Index first = first_kept(rank_of(comm_), total_, ranks);
  std::vector<std::size_t> order;
  const auto asked = exchange(comm_, sort_by_rank<Index>(sites, keepers_of(sites, total_, ranks), ranks, &order));
  Parcels<PetscInt> answers{{}, asked.counts};
  for (const Index site : asked.records) answers.records.push_back(table_[static_cast<std::size_t>(site - first)]);
  const std::vector<PetscInt> sorted = exchange(comm_, answers).records;
  std::vector<PetscInt> rows(sites.size());
  for (std::size_t k = 0; k < order.size(); ++k) rows[order[k]] = sorted[k] < 0 ? -1 : moved(sorted[k]);
  return rows;
}

void SiteDirectory::move(PetscInt first_row)
{
  spans_ = gather_all(comm_, std::vector<Span>{{first_, count_, first_row}});
}

PetscInt SiteDirectory::moved(PetscInt row) const
{
  for (const Span& span : spans_)
    if (row >= span.given && row < span.given + span.count) return span.now + row - span.given;
  return row;
}
} // namespace pdx::pd
