#pragma once
#include <algorithm>
#include <span>

namespace pdx {
/// Those in a row of a sorted list whose projection is `key`; none if there are none.
/// @param sorted ascending by the projection; outlives the result
template <class Records, class Key, class Projection>
auto run_of(const Records& sorted, const Key& key, Projection projection)
{
  const auto first = std::ranges::lower_bound(sorted, key, {}, projection);
  const auto last = std::ranges::upper_bound(sorted, key, {}, projection);
  return std::span(first, last);
}
} // namespace pdx
