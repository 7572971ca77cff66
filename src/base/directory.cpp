#include "pdx/base/directory.hpp"

#include "pdx/base/exchange.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>

namespace pdx {
namespace {
/// Neighbouring names go to different ranks, so that no rank keeps all that is near one place.
int keeper_of(std::uint64_t name, int ranks)
{
  constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15; // 2^64 over the golden ratio
  return static_cast<int>((name * kGolden >> 32) % static_cast<std::uint64_t>(ranks));
}

std::vector<int> keepers_of(std::span<const std::uint64_t> names, int ranks)
{
  std::vector<int> keepers(names.size());
  std::ranges::transform(names, keepers.begin(), [ranks](std::uint64_t name) { return keeper_of(name, ranks); });
  return keepers;
}

int ranks_of(MPI_Comm comm)
{
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}
} // namespace

Directory::Directory(MPI_Comm comm, std::span<const std::uint64_t> names) : comm_(comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::vector<Entry> mine;
  std::vector<int> keepers;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k] == 0) continue;
    mine.push_back({names[k], {rank, static_cast<Index>(k)}});
    keepers.push_back(keeper_of(names[k], ranks_of(comm)));
  }
  entries_ = exchange(comm, sort_by_rank<Entry>(mine, keepers, ranks_of(comm))).records;
  std::ranges::stable_sort(entries_, {}, &Entry::name);
  unique_ = !any_rank(comm, std::ranges::adjacent_find(entries_, {}, &Entry::name) != entries_.end());
}

std::vector<Whereabouts> Directory::find(std::span<const std::uint64_t> names) const
{
  std::vector<std::size_t> order;
  const auto asked =
      exchange(comm_, sort_by_rank<std::uint64_t>(names, keepers_of(names, ranks_of(comm_)), ranks_of(comm_), &order));
  Parcels<Whereabouts> answers{{}, asked.counts};
  auto next = entries_.begin(); // names mostly come in order
  for (const std::uint64_t name : asked.records) {
    const auto entry = next != entries_.end() && next->name == name
                           ? next
                           : std::ranges::lower_bound(entries_, name, {}, &Entry::name);
    const bool known = entry != entries_.end() && entry->name == name;
    answers.records.push_back(known ? entry->at : Whereabouts{});
    next = known ? entry + 1 : entry;
  }
  const std::vector<Whereabouts> sorted = exchange(comm_, answers).records;
  std::vector<Whereabouts> found(names.size());
  for (std::size_t k = 0; k < order.size(); ++k) found[order[k]] = sorted[k];
  return found;
}
} // namespace pdx
