#include "pdx/mpm/cell_blocks.hpp"

#include <algorithm>
#include <tuple>

namespace pdx::mpm {
namespace {
constexpr Index kLeastRun = 4; // cells; shorter ones leave too many lanes idle

/// b is behind a along a run, in rows too.
template <int Dim> bool follows(const CellRows<Dim>& a, const CellRows<Dim>& b)
{
  for (std::size_t k = 0; k < a.size(); ++k)
    if (b[k] != a[k] + 1) return false;
  return true;
}
template <int Dim> bool may_be_in_run(const CellRows<Dim>& rows, Index owned)
{
  for (std::size_t line = 0; line < CellRun<Dim>::kLines; ++line) {
    const Index low = rows[CellRun<Dim>::corner(line)], high = rows[CellRun<Dim>::corner(line) + CellRun<Dim>::kStep];
    if (high != low + 1 || high >= owned) return false;
  }
  return true;
}

template <int Dim> CellRun<Dim> run_from(const CellRows<Dim>& rows, Index cells)
{
  CellRun<Dim> run;
  for (std::size_t line = 0; line < run.first.size(); ++line) run.first[line] = rows[CellRun<Dim>::corner(line)];
  run.cells = cells;
  return run;
}

/// Takes runs out of `cells`, which are sorted by rows.
template <int Dim> std::vector<CellRun<Dim>> take_runs(std::vector<CellRows<Dim>>& cells, Index owned)
{
  std::vector<CellRun<Dim>> runs;
  std::vector<CellRows<Dim>> rest;
  for (std::size_t from = 0; from < cells.size();) {
    std::size_t to = from + 1;
    const bool possible = may_be_in_run<Dim>(cells[from], owned);
    while (possible && to < cells.size() && follows<Dim>(cells[to - 1], cells[to]) &&
           may_be_in_run<Dim>(cells[to], owned))
      ++to;
    if (static_cast<Index>(to - from) >= kLeastRun)
      runs.push_back(run_from<Dim>(cells[from], static_cast<Index>(to - from)));
    else
      rest.insert(rest.end(), cells.begin() + static_cast<std::ptrdiff_t>(from),
                  cells.begin() + static_cast<std::ptrdiff_t>(to));
    from = to;
  }
  cells = std::move(rest);
  return runs;
}
} // namespace

template <int Dim> const CellPoints<Dim>& PointPatterns<Dim>::of(Index body, std::uint64_t mask)
{
  const auto at = known_.find({body, mask});
  if (at != known_.end()) return at->second;
  return known_.emplace(std::pair(body, mask), CellPoints<Dim>(bodies_[static_cast<std::size_t>(body)], mask))
      .first->second;
}

template <int Dim>
CellBlocks<Dim>::CellBlocks(std::vector<LocalCell<Dim>> cells, Index owned, std::span<const BodyMaterial> bodies,
                            PointPatterns<Dim>& patterns)
{
  std::ranges::sort(cells, {}, [](const auto& c) { return std::tie(c.body, c.points, c.rows); });
  for (std::size_t from = 0; from < cells.size();) {
    std::size_t to = from;
    Block block{cells[from].body, &patterns.of(cells[from].body, cells[from].points), {}, {}};
    for (; to < cells.size() && cells[to].body == block.body && cells[to].points == block.points->mask; ++to)
      block.cells.push_back(cells[to].rows);
    const int ratio = bodies[static_cast<std::size_t>(block.body)].ratio;
    if (runs_are_swept(ratio) && block.points->mask == full_mask<Dim>(ratio))
      block.runs = take_runs<Dim>(block.cells, owned);
    blocks_.push_back(std::move(block));
    from = to;
  }
}

template class PointPatterns<2>;
template class PointPatterns<3>;
template class CellBlocks<2>;
template class CellBlocks<3>;
} // namespace pdx::mpm
