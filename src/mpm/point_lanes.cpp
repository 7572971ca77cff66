#include "pdx/mpm/point_lanes.hpp"

#include <cmath>
#include <numeric>

namespace pdx::mpm {
namespace {
constexpr Index kMargin = 3;      // cells around the points, so that few steps find one outside
constexpr double kFarthest = 1e8; // cells: beyond that numbers are no places any more
constexpr std::size_t kMostBlocks = std::size_t{1} << 21, kBlocksPerPoint = 2;

Index floor_to_block(Index cell, Index lanes)
{
  return cell >= 0 ? cell / lanes * lanes : -((-cell + lanes - 1) / lanes * lanes);
}
} // namespace

template <int Dim>
PointLanes<Dim>::PointLanes(double begin, std::vector<GridPoint<Dim>> points) : begin_(begin), size_(points.size())
{
  settle(std::move(points));
}

template <int Dim> Site<Dim> PointLanes<Dim>::cell_of(const Vector<Dim>& at) const
{
  Site<Dim> cell;
  for (std::size_t d = 0; d < Dim; ++d) {
    const double x = at[static_cast<Eigen::Index>(d)];
    if (!(std::abs(x) < kFarthest))
      throw SolverFailure("a material point is nowhere any more: it flew off or its speed is no number");
    cell[d] = static_cast<Index>(std::floor(x - begin_));
  }
  return cell;
}

template <int Dim> auto PointLanes<Dim>::block_of(const Site<Dim>& cell) -> Block*
{
  std::size_t number = 0;
  for (std::size_t d = Dim; d-- > 0;) {
    if (cell[d] < lower_[d] || cell[d] > upper_[d]) return nullptr;
    const Index along = (cell[d] - lower_[d]) / (d == 0 ? kLanes : 1);
    number = number * static_cast<std::size_t>(count_[d]) + static_cast<std::size_t>(along);
  }
  return &blocks_[number];
}

template <int Dim> void PointLanes<Dim>::settle(std::vector<GridPoint<Dim>> points)
{
  lower_.fill(0);
  upper_.fill(0);
  std::vector<Site<Dim>> cells;
  for (const GridPoint<Dim>& p : points) {
    cells.push_back(cell_of(p.at));
    for (std::size_t d = 0; d < Dim; ++d) {
      lower_[d] = cells.size() == 1 ? cells.back()[d] : std::min(lower_[d], cells.back()[d]);
      upper_[d] = cells.size() == 1 ? cells.back()[d] : std::max(upper_[d], cells.back()[d]);
    }
  }
  const auto most = [](double a, double b) { return std::max(a, b); };
  std::size_t all = 1;
  for (std::size_t d = 0; d < Dim; ++d) {
    lower_[d] -= kMargin;
    upper_[d] += kMargin;
    if (d == 0) lower_[0] = floor_to_block(lower_[0], kLanes);
    count_[d] = d == 0 ? (upper_[0] - lower_[0]) / kLanes + 1 : upper_[d] - lower_[d] + 1;
    if (d == 0) upper_[0] = lower_[0] + count_[0] * kLanes - 1;
    all *= static_cast<std::size_t>(count_[d]);
    if (all > std::max(kMostBlocks, kBlocksPerPoint * size_))
      throw TooFarApart(std::transform_reduce(points.begin(), points.end(), 0.0, most,
                                              [](const GridPoint<Dim>& p) { return p.v.norm(); }));
  }
  blocks_.assign(all, {});
  for (std::size_t k = 0; k < all; ++k) {
    std::size_t rest = k;
    for (std::size_t d = 0; d < Dim; ++d) {
      blocks_[k].cell[d] =
          lower_[d] + static_cast<Index>(rest % static_cast<std::size_t>(count_[d])) * (d == 0 ? kLanes : 1);
      rest /= static_cast<std::size_t>(count_[d]);
    }
  }
  for (const Site<Dim>& cell : cells) {
    Block& block = *block_of(cell);
    double& count = block.counts[cell[0] - block.cell[0]];
    block.room = std::max(block.room, static_cast<int>(count += 1.0));
  }
  std::size_t slots = 0;
  for (Block& block : blocks_) {
    if (block.room) ++block.room; // one may come
    block.first = slots;
    slots += static_cast<std::size_t>(block.room);
    std::fill_n(block.counts, kLanes, 0.0);
  }
  data_.assign(slots * kSlot, 0.0);
  ids_.assign(slots * kLanes, 0);
  for (std::size_t k = 0; k < points.size(); ++k) {
    Block& block = *block_of(cells[k]);
    insert(block, points[k], cells[k][0] - block.cell[0]);
  }
}

template <int Dim> GridPoint<Dim> PointLanes<Dim>::taken(const Block& block, int s, int lane) const
{
  const double* numbers = slot(block, s) + lane;
  GridPoint<Dim> p;
  p.id = ids_[at(block, s, lane)];
  for (int d = 0; d < Dim; ++d, numbers += kLanes) p.at[d] = *numbers;
  for (int d = 0; d < Dim; ++d, numbers += kLanes) p.v[d] = *numbers;
  for (int d = 0; d < Dim * Dim; ++d, numbers += kLanes) p.h(d / Dim, d % Dim) = *numbers;
  return p;
}

template <int Dim> void PointLanes<Dim>::put(const Block& block, int s, int lane, const GridPoint<Dim>& p)
{
  double* numbers = slot(block, s) + lane;
  ids_[at(block, s, lane)] = p.id;
  for (int d = 0; d < Dim; ++d, numbers += kLanes) *numbers = p.at[d];
  for (int d = 0; d < Dim; ++d, numbers += kLanes) *numbers = p.v[d];
  for (int d = 0; d < Dim * Dim; ++d, numbers += kLanes) *numbers = p.h(d / Dim, d % Dim);
}

template <int Dim> void PointLanes<Dim>::copy(const Block& block, int from, int to, int lane)
{
  ids_[at(block, to, lane)] = ids_[at(block, from, lane)];
  for (int n = 0; n < kNumbers; ++n) slot(block, to)[n * kLanes + lane] = slot(block, from)[n * kLanes + lane];
}

template <int Dim> void PointLanes<Dim>::widen(Block& block)
{
  const std::size_t from = block.first, old = static_cast<std::size_t>(block.room),
                    room = std::max<std::size_t>(2 * old, 4);
  block.first = ids_.size() / kLanes;
  block.room = static_cast<int>(room);
  data_.resize((block.first + room) * kSlot, 0.0);
  ids_.resize((block.first + room) * kLanes, 0);
  std::copy_n(data_.begin() + static_cast<std::ptrdiff_t>(from * kSlot), old * kSlot,
              data_.begin() + static_cast<std::ptrdiff_t>(block.first * kSlot));
  std::copy_n(ids_.begin() + static_cast<std::ptrdiff_t>(from * kLanes), old * kLanes,
              ids_.begin() + static_cast<std::ptrdiff_t>(block.first * kLanes));
}

template <int Dim> void PointLanes<Dim>::insert(Block& block, const GridPoint<Dim>& point, int lane)
{
  int place = static_cast<int>(block.counts[lane]);
  if (place == block.room) widen(block);
  for (; place > 0 && ids_[at(block, place - 1, lane)] > point.id; --place) copy(block, place - 1, place, lane);
  put(block, place, lane, point);
  block.counts[lane] += 1.0;
  block.slots = std::max(block.slots, static_cast<int>(block.counts[lane]));
}

template <int Dim> void PointLanes<Dim>::take_out(Block& block, std::vector<GridPoint<Dim>>& out)
{
  block.slots = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    Site<Dim> here = block.cell;
    here[0] += lane;
    int kept = 0;
    for (int s = 0; s < static_cast<int>(block.counts[lane]); ++s) {
      const GridPoint<Dim> p = taken(block, s, lane);
      if (cell_of(p.at) != here)
        out.push_back(p);
      else if (kept++ < s)
        copy(block, s, kept - 1, lane);
    }
    block.counts[lane] = kept;
    block.slots = std::max(block.slots, kept);
  }
}

template <int Dim> bool PointLanes<Dim>::regroup()
{
  std::vector<GridPoint<Dim>> moved;
  bool inside = true;
  for (Block& block : blocks_) {
    if (!block.crossed) continue;
    block.crossed = 0;
    take_out(block, moved);
  }
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const Site<Dim> cell = cell_of(moved[k].at);
    Block* const block = block_of(cell);
    if (block)
      insert(*block, moved[k], cell[0] - block->cell[0]);
    else {
      std::vector<GridPoint<Dim>> all = points();
      all.insert(all.end(), moved.begin() + static_cast<std::ptrdiff_t>(k), moved.end());
      settle(std::move(all));
      return false;
    }
  }
  return inside;
}

template <int Dim> std::vector<GridPoint<Dim>> PointLanes<Dim>::points() const
{
  std::vector<GridPoint<Dim>> all;
  all.reserve(size_);
  for (const Block& block : blocks_)
    for (int lane = 0; lane < kLanes; ++lane)
      for (int s = 0; s < static_cast<int>(block.counts[lane]); ++s) all.push_back(taken(block, s, lane));
  std::ranges::sort(all, {}, &GridPoint<Dim>::id);
  return all;
}

template class PointLanes<2>;
template class PointLanes<3>;
} // namespace pdx::mpm
