#include "pdx/couple/foreign_ends.hpp"

#include <algorithm>
#include <cassert>

namespace pdx::couple {
ForeignEnds::ForeignEnds(const pd::LatticePart<2>& part)
{
  int ranks = 1;
  MPI_Comm_size(part.comm(), &ranks);
  if (ranks == 1) return;
  for (const Index number : part.sites()) {
    const Site<2> site = part.site(number);
    for (const pd::Arm<2>& arm : part.stencil().half) {
      const Site<2> end{site[0] + arm.step[0], site[1] + arm.step[1]};
      if (!part.active().has(end)) continue;
      const Index other = part.number(end);
      if (!std::ranges::binary_search(part.sites(), other)) sites_.push_back(other);
    }
  }
  std::ranges::sort(sites_);
  sites_.erase(std::unique(sites_.begin(), sites_.end()), sites_.end());
  rows_ = part.directory().rows(sites_);
}

PetscInt ForeignEnds::row(Index site) const
{
  const auto at = std::ranges::lower_bound(sites_, site);
  assert(at != sites_.end() && *at == site);
  return rows_[static_cast<std::size_t>(at - sites_.begin())];
}
} // namespace pdx::couple
