#include "pdx/geom/site_set.hpp"

#include "pdx/geom/box.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace pdx::geom {
namespace {
using Interval = std::pair<Index, Index>;
using Intervals = std::vector<Interval>;

Intervals united(Intervals all)
{
  std::ranges::sort(all);
  Intervals joined;
  for (const auto& [first, end] : all) {
    if (first >= end) continue;
    if (!joined.empty() && first <= joined.back().second)
      joined.back().second = std::max(joined.back().second, end);
    else
      joined.push_back({first, end});
  }
  return joined;
}

Intervals common(const Intervals& a, const Intervals& b)
{
  Intervals both;
  for (const auto& [first, end] : a)
    for (const auto& [from, to] : b)
      if (std::max(first, from) < std::min(end, to)) both.push_back({std::max(first, from), std::min(end, to)});
  return both;
}

/// What lies in a only.
Intervals rest(const Intervals& a, const Intervals& b)
{
  Intervals left;
  for (auto [first, end] : a) {
    for (const auto& [from, to] : b) {
      if (to <= first || from >= end) continue;
      if (from > first) left.push_back({first, from});
      first = to;
    }
    if (first < end) left.push_back({first, end});
  }
  return left;
}
} // namespace

template <int Dim> SiteSet<Dim>::SiteSet(std::span<const Corners> boxes)
{
  if (boxes.empty()) return;
  Site<Dim> lower = boxes[0].first, upper = boxes[0].second;
  for (const auto& [low, high] : boxes)
    for (std::size_t d = 0; d < Dim; ++d) {
      lower[d] = std::min(lower[d], low[d]);
      upper[d] = std::max(upper[d], high[d]);
    }
  lower_ = lower;
  upper_ = upper;
  size_ = 1;
  for (std::size_t d = 0; d < Dim; ++d) size_ *= upper[d] - lower[d];
  for (const auto& [low, high] : boxes)
    if (low == lower && high == upper) return; // a box
  std::size_t count = 1;
  for (std::size_t d = 1; d < Dim; ++d) count *= static_cast<std::size_t>(upper[d] - lower[d]);
  Rows rows(count);
  for (std::size_t r = 0; r < count; ++r) {
    const Site<Dim> start = row_start(r);
    for (const auto& [low, high] : boxes) {
      bool meets = true;
      for (std::size_t d = 1; d < Dim; ++d) meets = meets && start[d] >= low[d] && start[d] < high[d];
      if (meets) rows[r].push_back({low[0], high[0]});
    }
  }
  *this = SiteSet(lower, upper, std::move(rows));
}

/// Rows of the box [lower, upper), of which the set may fill less.
template <int Dim> SiteSet<Dim>::SiteSet(const Site<Dim>& lower, const Site<Dim>& upper, Rows rows)
{
  lower_ = lower;
  upper_ = upper;
  Site<Dim> least = upper, most = lower;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r] = united(std::move(rows[r]));
    if (rows[r].empty()) continue;
    Site<Dim> first = row_start(r), last = first;
    first[0] = rows[r].front().first;
    last[0] = rows[r].back().second - 1;
    for (const Site<Dim>& site : {first, last})
      for (std::size_t d = 0; d < Dim; ++d) {
        least[d] = std::min(least[d], site[d]);
        most[d] = std::max(most[d], site[d] + 1);
      }
    for (const auto& [from, to] : rows[r]) size_ += to - from;
  }
  if (size_ == 0) {
    lower_ = upper_ = {};
    return;
  }
  std::int64_t room = 1;
  for (std::size_t d = 0; d < Dim; ++d) room *= most[d] - least[d];
  box_ = room == size_;
  if (!box_) {
    first_.push_back(0);
    std::int64_t place = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      Site<Dim> start = row_start(r);
      bool meets = true;
      for (std::size_t d = 1; d < Dim; ++d) meets = meets && start[d] >= least[d] && start[d] < most[d];
      if (!meets) continue;
      for (const auto& [from, to] : rows[r]) {
        start[0] = from;
        runs_.push_back({start, to - from, place});
        place += to - from;
      }
      first_.push_back(runs_.size());
    }
  }
  lower_ = least;
  upper_ = most;
  if (box_) return;
  has_.assign(static_cast<std::size_t>(room), false);
  for (const SiteRun<Dim>& run : runs_) {
    const auto begin = has_.begin() + static_cast<std::ptrdiff_t>(bit(run.first));
    std::fill(begin, begin + run.length, true);
  }
}

template <int Dim> Site<Dim> SiteSet<Dim>::row_start(std::size_t row) const
{
  Site<Dim> start = lower_;
  for (std::size_t d = 1; d < Dim; ++d) {
    const auto count = static_cast<std::size_t>(upper_[d] - lower_[d]);
    start[d] += static_cast<Index>(row % count);
    row /= count;
  }
  return start;
}

template <int Dim> std::span<const SiteRun<Dim>> SiteSet<Dim>::runs_of(std::size_t row) const
{
  return std::span(runs_).subspan(first_[row], first_[row + 1] - first_[row]);
}

template <int Dim> const SiteRun<Dim>* SiteSet<Dim>::run_at(const Site<Dim>& site) const
{
  for (const SiteRun<Dim>& run : runs_of(row(site)))
    if (site[0] >= run.first[0] && site[0] < run.first[0] + run.length) return &run;
  return nullptr;
}

template <int Dim> bool SiteSet<Dim>::has_all(const Corners& box) const
{
  Site<Dim> site = box.first;
  for (std::size_t d = 0; d < Dim; ++d)
    if (box.first[d] >= box.second[d]) return true;
  for (;;) { // row by row
    if (!has(site) || end_of_run(site) < box.second[0]) return false;
    std::size_t d = 1;
    for (; d < Dim; ++d) {
      if (++site[d] < box.second[d]) break;
      site[d] = box.first[d];
    }
    if (d == Dim) return true;
  }
}

template <int Dim> std::int64_t SiteSet<Dim>::place(const Site<Dim>& site) const
{
  if (!box_) {
    const SiteRun<Dim>& run = *run_at(site);
    return run.place + site[0] - run.first[0];
  }
  std::int64_t n = 0;
  for (std::size_t d = Dim; d-- > 0;) n = n * (upper_[d] - lower_[d]) + (site[d] - lower_[d]);
  return n;
}

template <int Dim> Site<Dim> SiteSet<Dim>::site(std::int64_t place) const
{
  Site<Dim> s{};
  if (!box_) {
    const auto run = std::ranges::upper_bound(runs_, place, {}, &SiteRun<Dim>::place) - 1;
    s = run->first;
    s[0] += static_cast<Index>(place - run->place);
    return s;
  }
  for (std::size_t d = 0; d < Dim; ++d) {
    const Index count = upper_[d] - lower_[d];
    s[d] = lower_[d] + static_cast<Index>(place % count);
    place /= count;
  }
  return s;
}

template <int Dim> Index SiteSet<Dim>::end_of_run(const Site<Dim>& site) const
{
  if (box_) return upper_[0];
  const SiteRun<Dim>& run = *run_at(site);
  return run.first[0] + run.length;
}

template <int Dim> std::vector<SiteRun<Dim>> SiteSet<Dim>::runs() const
{
  if (!box_ || size_ == 0) return runs_;
  std::vector<SiteRun<Dim>> all;
  const Index length = upper_[0] - lower_[0];
  for (std::int64_t place = 0; place < size_; place += length)
    all.push_back({row_start(static_cast<std::size_t>(place / length)), length, place});
  return all;
}

/// Rows first along the other directions, then each along x.
template <int Dim> SiteSet<Dim> SiteSet<Dim>::stretched(Index width, bool grow) const
{
  if (size_ == 0) return {};
  SiteSet frame; // of the rows
  for (std::size_t d = 0; d < Dim; ++d) {
    frame.lower_[d] = lower_[d] - (grow ? width : -width);
    frame.upper_[d] = upper_[d] + (grow ? width : -width);
    if (frame.lower_[d] >= frame.upper_[d]) return {};
  }
  if (box_) return SiteSet(Corners{frame.lower_, frame.upper_});
  std::size_t count = 1;
  for (std::size_t d = 1; d < Dim; ++d) count *= static_cast<std::size_t>(frame.upper_[d] - frame.lower_[d]);
  Rows rows(count);
  for (std::size_t r = 0; r < count; ++r) {
    const Site<Dim> middle = frame.row_start(r);
    Site<Dim> near = middle;
    for (std::size_t d = 1; d < Dim; ++d) near[d] -= width;
    for (bool first = true;; first = false) {
      Intervals here;
      bool in = true;
      for (std::size_t d = 1; d < Dim; ++d) in = in && near[d] >= lower_[d] && near[d] < upper_[d];
      if (in)
        for (const SiteRun<Dim>& run : runs_of(row(near))) here.push_back({run.first[0], run.first[0] + run.length});
      if (grow || first)
        rows[r].insert(rows[r].end(), here.begin(), here.end());
      else
        rows[r] = common(rows[r], here);
      std::size_t d = 1;
      for (; d < Dim; ++d) {
        if (++near[d] <= middle[d] + width) break;
        near[d] = middle[d] - width;
      }
      if (d == Dim) break;
    }
    if (!grow) rows[r] = united(std::move(rows[r]));
    for (auto& [from, to] : rows[r]) {
      from -= grow ? width : -width;
      to += grow ? width : -width;
    }
  }
  return SiteSet(frame.lower_, frame.upper_, std::move(rows));
}

template <int Dim> SiteSet<Dim> SiteSet<Dim>::eroded(Index width) const { return stretched(width, false); }
template <int Dim> SiteSet<Dim> SiteSet<Dim>::grown(Index width) const { return stretched(width, true); }

std::vector<StraightSide> straight_sides(const SiteSet<2>& set)
{
  std::map<Index, Intervals> rows;
  std::vector<StraightSide> sides;
  std::map<std::pair<bool, Index>, Intervals> across; // axis 0: rows of each line
  for (const SiteRun<2>& run : set.runs()) {
    const Index y = run.first[1], end = run.first[0] + run.length;
    rows[y].push_back({run.first[0], end});
    across[{false, run.first[0]}].push_back({y, y + 1});
    across[{true, end}].push_back({y, y + 1});
  }
  for (auto& [line, pieces] : across)
    for (const auto& [from, to] : united(std::move(pieces))) sides.push_back({0, line.first, line.second, from, to});
  for (const bool upper : {false, true})
    for (const auto& [y, row] : rows) {
      const auto next = rows.find(upper ? y + 1 : y - 1);
      for (const auto& [from, to] : rest(row, next == rows.end() ? Intervals() : next->second))
        sides.push_back({1, upper, upper ? y + 1 : y, from, to});
    }
  return sides;
}

bool covers(const ActiveLattice<2>& where, const Vector<2>& x, double margin)
{
  const auto& [lattice, set] = where;
  if (set.is_box()) {
    const Vector<2> lower(set.lower()[0], set.lower()[1]), upper(set.upper()[0], set.upper()[1]);
    return Box<2>{lattice.origin + lattice.dx * lower, lattice.origin + lattice.dx * upper}.contains(x, margin);
  }
  const Vector<2> at = (x - lattice.origin) / lattice.dx;
  const double near = margin / lattice.dx;
  const auto first = [near](double s) { return static_cast<Index>(std::ceil(s - near)) - 1; };
  const auto last = [near](double s) { return static_cast<Index>(std::floor(s + near)); };
  for (Site<2> site{0, first(at[1])}; site[1] <= last(at[1]); ++site[1])
    for (site[0] = first(at[0]); site[0] <= last(at[0]); ++site[0])
      if (set.has(site)) return true;
  return false;
}

template class SiteSet<2>;
template class SiteSet<3>;
} // namespace pdx::geom
