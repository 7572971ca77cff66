#include "pdx/solve/load_path.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::solve {
LoadPath::LoadPath(int increments, int max_halvings)
    : increments_(increments), parts_(std::int64_t{1} << max_halvings), size_(parts_)
{}

double LoadPath::target() const
{
  const std::int64_t end = at_ + size_;
  if (end == parts_) return static_cast<double>(increment_ + 1) / increments_;
  return (increment_ + static_cast<double>(end) / static_cast<double>(parts_)) / increments_;
}

double LoadPath::reached() const
{
  if (at_ == 0) return static_cast<double>(increment_) / increments_;
  return (increment_ + static_cast<double>(at_) / static_cast<double>(parts_)) / increments_;
}

double LoadPath::size() const { return static_cast<double>(size_) / static_cast<double>(parts_) / increments_; }

void LoadPath::advance()
{
  at_ += size_;
  if (at_ == parts_) {
    at_ = 0;
    ++increment_;
  }
  if (size_ < parts_ && at_ % (2 * size_) == 0) size_ *= 2;
}

LoadPath::Place LoadPath::place() const
{
  const auto whole = static_cast<double>(parts_);
  return {increment_, static_cast<double>(at_) / whole, static_cast<double>(size_) / whole};
}

bool LoadPath::go_on_from(const Place& place)
{
  const double whole = static_cast<double>(parts_), at = place.done * whole;
  if (at != std::floor(at)) return false;
  increment_ = place.increments;
  at_ = static_cast<std::int64_t>(at);
  size_ = std::max<std::int64_t>(1, static_cast<std::int64_t>(place.size * whole));
  while (at_ % size_ != 0) size_ /= 2; // whatever was tried, it ends within the increment
  return true;
}

bool LoadPath::halve()
{
  if (size_ == 1) return false;
  size_ /= 2;
  return true;
}
} // namespace pdx::solve
