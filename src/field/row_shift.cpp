#include "pdx/field/row_shift.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <numeric>

namespace pdx::field {
RowShift::RowShift(std::unique_ptr<RowHalo> before, std::span<const Run> mine)
    : before_(std::move(before)), runs_(gather_all(before_->rows().comm, std::vector<Run>(mine.begin(), mine.end())))
{}

PetscInt RowShift::operator()(PetscInt row) const
{
  const auto next = std::ranges::upper_bound(runs_, row, {}, &Run::from);
  if (next == runs_.begin()) return -1;
  const Run& run = *std::prev(next);
  return row < run.from + run.length ? run.to + row - run.from : -1;
}

std::vector<Index> RowShift::local_rows(const RowHalo& now, std::span<const Index> halo) const
{
  const Rows &old = before_->rows(), &next = now.rows();
  std::vector<Index> local(static_cast<std::size_t>(before_->size()), -1);
  for (const Run& run : runs_)
    if (run.length > 0 && old.owns(run.from))
      std::iota(local.begin() + (run.from - old.first), local.begin() + (run.from - old.first + run.length),
                static_cast<Index>(run.to - next.first));
  for (const Index row : halo) local[static_cast<std::size_t>(row)] = now.local((*this)(before_->global(row)));
  return local;
}
} // namespace pdx::field
