#include "pdx/field/staying_rows.hpp"

#include <algorithm>

namespace pdx::field {
namespace {
/// What of 0 ... count is in none of the runs, which begin there.
std::vector<Index> outside(std::vector<StayingRows::Run> runs, Index StayingRows::Run::*begin, Index count)
{
  std::ranges::sort(runs, {}, begin);
  std::vector<Index> rows;
  Index next = 0;
  for (const StayingRows::Run& run : runs) {
    for (; next < run.*begin; ++next) rows.push_back(next);
    next = std::max(next, run.*begin + run.length);
  }
  for (; next < count; ++next) rows.push_back(next);
  return rows;
}
} // namespace

std::vector<Index> StayingRows::leaving() const { return outside(runs, &Run::from, before); }
std::vector<Index> StayingRows::coming() const { return outside(runs, &Run::to, now); }

StayingRows StayingRows::behind(Index first_before, Index first_now) const
{
  StayingRows rows{before - first_before, now - first_now, {}, {}};
  for (const Run& run : runs)
    if (run.from >= first_before) rows.runs.push_back({run.from - first_before, run.to - first_now, run.length});
  return rows;
}

void StayingRows::carry(std::vector<double>& values, int components) const
{
  const auto at = [components](Index row) { return std::ptrdiff_t{row} * components; };
  std::vector<Run> moved;
  Index same = 0; // rows at the beginning that stay where they are
  for (const Run& run : runs)
    if (run.from == same && run.to == same)
      same += run.length;
    else
      moved.push_back(run);
  const std::vector<double> rest(values.begin() + at(same), values.begin() + at(before));
  values.resize(static_cast<std::size_t>(at(same)));
  values.resize(static_cast<std::size_t>(at(now)), 0.0);
  for (const Run& run : moved)
    std::copy_n(rest.begin() + at(run.from - same), at(run.length), values.begin() + at(run.to));
}

std::vector<double> values_of(std::span<const Index> rows, std::span<const double> values, int components)
{
  std::vector<double> some;
  some.reserve(rows.size() * static_cast<std::size_t>(components));
  for (const Index row : rows) {
    const auto from = values.begin() + std::ptrdiff_t{row} * components;
    some.insert(some.end(), from, from + components);
  }
  return some;
}
} // namespace pdx::field
