#include "pdx/mesh/cell_finder.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::mesh {
namespace {
/// Numbers sorted by the group of each: where those of a group begin, one more at the end, and all of them.
void sort_by_group(std::size_t groups, std::span<const std::size_t> group, std::size_t per_number,
                   std::vector<Index>& first, std::vector<Index>& sorted)
{
  first.assign(groups + 1, 0);
  for (const std::size_t g : group) ++first[g + 1];
  for (std::size_t g = 0; g < groups; ++g) first[g + 1] += first[g];
  std::vector<Index> next(first.begin(), first.end() - 1);
  sorted.resize(group.size());
  for (std::size_t k = 0; k < group.size(); ++k)
    sorted[static_cast<std::size_t>(next[group[k]]++)] = static_cast<Index>(k / per_number);
}
} // namespace

CellFinder::CellFinder(std::span<const std::array<Index, 4>> cells, std::span<const Vector<2>> points)
{
  std::vector<std::size_t> groups;
  for (const std::array<Index, 4>& cell : cells) {
    Vector<2> sum(0.0, 0.0);
    for (const Index v : cell) {
      groups.push_back(static_cast<std::size_t>(v));
      sum += points[static_cast<std::size_t>(v)];
    }
    middles_.push_back(0.25 * sum);
    for (const Index v : cell)
      reach_ = std::max(reach_, (points[static_cast<std::size_t>(v)] - middles_.back()).lpNorm<Eigen::Infinity>());
  }
  sort_by_group(points.size(), groups, 4, first_at_, at_);
  if (cells.empty()) {
    first_in_.assign(2, 0);
    return;
  }
  Vector<2> upper = origin_ = middles_.front();
  for (const Vector<2>& x : middles_) {
    origin_ = origin_.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  const Vector<2> size = upper - origin_;
  const double longest = size.maxCoeff(), area = std::max(size[0], longest * 1e-3) * std::max(size[1], longest * 1e-3);
  side_ =
      longest > 0.0 ? 2.0 * std::sqrt(area / static_cast<double>(cells.size())) : 1.0; // four cells, if they are even
  bins_ = {1, 1};
  bins_ = bin_of(upper);
  for (Index& count : bins_) ++count;
  groups.clear();
  for (const Vector<2>& x : middles_) groups.push_back(number(bin_of(x)[0], bin_of(x)[1]));
  sort_by_group(static_cast<std::size_t>(bins_[0]) * static_cast<std::size_t>(bins_[1]), groups, 1, first_in_, in_);
}

std::array<Index, 2> CellFinder::bin_of(const Vector<2>& x) const
{
  std::array<Index, 2> bin{};
  for (std::size_t d = 0; d < 2; ++d) {
    const double at = std::floor((x[static_cast<Eigen::Index>(d)] - origin_[static_cast<Eigen::Index>(d)]) / side_);
    bin[d] = static_cast<Index>(std::clamp(at, 0.0, 1e6));
  }
  return bin;
}

std::span<const Index> CellFinder::at(Index vertex) const
{
  const auto v = static_cast<std::size_t>(vertex);
  return std::span(at_).subspan(static_cast<std::size_t>(first_at_[v]),
                                static_cast<std::size_t>(first_at_[v + 1] - first_at_[v]));
}

namespace {
std::vector<Index> once(std::vector<Index> numbers)
{
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}
} // namespace

std::vector<Index> CellFinder::around(std::span<const geom::Box<2>> boxes) const
{
  std::vector<Index> cells;
  for (geom::Box<2> box : boxes) {
    box.lower.array() -= 1.001 * reach_;
    box.upper.array() += 1.001 * reach_;
    const std::vector<Index> more = in(box);
    cells.insert(cells.end(), more.begin(), more.end());
  }
  return once(std::move(cells));
}

std::vector<Index> CellFinder::at_any(std::span<const Index> vertices) const
{
  std::vector<Index> cells;
  for (const Index v : vertices) cells.insert(cells.end(), at(v).begin(), at(v).end());
  return once(std::move(cells));
}

std::vector<Index> CellFinder::in(const geom::Box<2>& box) const
{
  std::vector<Index> found;
  const auto lower = bin_of(box.lower), upper = bin_of(box.upper);
  for (Index j = lower[1]; j <= std::min(upper[1], bins_[1] - 1); ++j)
    for (Index i = lower[0]; i <= std::min(upper[0], bins_[0] - 1); ++i) {
      const std::size_t bin = number(i, j);
      for (Index k = first_in_[bin]; k < first_in_[bin + 1]; ++k)
        if (const Index cell = in_[static_cast<std::size_t>(k)]; box.contains(middles_[static_cast<std::size_t>(cell)]))
          found.push_back(cell);
    }
  std::ranges::sort(found);
  return found;
}
} // namespace pdx::mesh
