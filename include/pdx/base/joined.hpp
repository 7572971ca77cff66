#pragma once
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace pdx {
/// Sets of numbers that are joined one by one; a set's root is its lowest number.
class Joined {
public:
  explicit Joined(std::size_t size = 0) : parent_(size) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  /// A set of its own; returns its number.
  std::size_t add()
  {
    parent_.push_back(parent_.size());
    return parent_.size() - 1;
  }
  std::size_t root(std::size_t k)
  {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(std::size_t a, std::size_t b)
  {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<std::size_t> parent_;
};
} // namespace pdx
