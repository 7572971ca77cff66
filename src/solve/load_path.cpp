#include "pdx/solve/load_path.hpp"

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

bool LoadPath::halve()
{
  if (size_ == 1) return false;
  size_ /= 2;
  return true;
}
} // namespace pdx::solve
