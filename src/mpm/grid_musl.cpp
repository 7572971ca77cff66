#include "pdx/base/events.hpp"
#include "pdx/mpm/grid_motion.hpp"

#include <algorithm>
#include <array>

/// A step in which stress comes last, as a wave of layers across the last axis: points give, what is settled by then
/// they take, and what they brought strains them, a layer or two behind each other, so that they are loaded once. What
/// other ranks have a share in comes before and after.
namespace pdx::mpm {
namespace grid_musl {
struct Reach {
  Index first, count; ///< nodes that a point sees along an axis: from its cell's number on
};
Reach reach_of(Shape shape) { return shape == Shape::hat ? Reach{0, 2} : Reach{-1, 3}; }
} // namespace grid_musl

template <int Dim> SomeBlocks GridMotion<Dim>::layer_of(std::size_t body, Index layer) const
{
  const PointLanes<Dim>& points = points_[body];
  const Index low = points.lowest()[Dim - 1], high = points.highest()[Dim - 1];
  if (points.size() == 0 || layer < low || layer > high) return {0, 0};
  const std::size_t wide = points.blocks().size() / static_cast<std::size_t>(high - low + 1),
                    from = static_cast<std::size_t>(layer - low) * wide;
  return {from, from + wide};
}

/// @return whether other blocks have points than before; on one rank that does not matter
template <int Dim> bool GridMotion<Dim>::find_seen()
{
  int ranks = 1;
  MPI_Comm_size(comm_, &ranks);
  if (ranks == 1) return false;
  const auto [first, count] = grid_musl::reach_of(rule_.shape);
  bool others = false;
  first_seen_.fill(std::numeric_limits<Index>::max());
  last_seen_.fill(std::numeric_limits<Index>::min());
  filled_.resize(points_.size());
  for (std::size_t b = 0; b < points_.size(); ++b) {
    const std::span<const typename PointLanes<Dim>::Block> blocks = points_[b].blocks();
    filled_[b].resize(blocks.size());
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      const std::uint8_t any = blocks[k].slots > 0;
      others |= std::exchange(filled_[b][k], any) != any;
      for (std::size_t d = 0; any && d < Dim; ++d) {
        const Index low = blocks[k].cell[d] + first;
        first_seen_[d] = std::min(first_seen_[d], low);
        last_seen_[d] = std::max(last_seen_[d], low + count - 1 + (d == 0 ? PointLanes<Dim>::kLanes - 1 : 0));
      }
    }
  }
  return others;
}

template <int Dim> void GridMotion<Dim>::find_borders()
{
  const auto [first, count] = grid_musl::reach_of(rule_.shape);
  inner_.assign(points_.size(), {});
  border_.assign(points_.size(), {});
  for (std::size_t b = 0; b < points_.size(); ++b) {
    const PointLanes<Dim>& points = points_[b];
    for (Index layer = points.lowest()[Dim - 1]; points.size() > 0 && layer <= points.highest()[Dim - 1]; ++layer) {
      std::vector<SomeBlocks>&inner = inner_[b].emplace_back(), *before = nullptr;
      const SomeBlocks all = layer_of(b, layer);
      for (std::size_t k = all.from; k < all.to; ++k) {
        if (!filled_.empty() && !filled_[b][k]) continue; // may lie within a list, to which it gives nothing
        Site<Dim> lower = points.blocks()[k].cell, upper = lower;
        for (std::size_t d = 0; d < Dim; ++d) {
          lower[d] += first;
          upper[d] += first + count - 1 + (d == 0 ? PointLanes<Dim>::kLanes - 1 : 0);
        }
        std::vector<SomeBlocks>& list = nodes_.is_shared(lower, upper) ? border_[b] : inner;
        if (std::exchange(before, &list) == &list)
          list.back().to = k + 1;
        else
          list.push_back({k, k + 1});
      }
    }
  }
}

/// Of the lists of nodes: the first, and how many.
template <int Dim> std::pair<std::size_t, std::size_t> GridMotion<Dim>::nodes_of(const Layers& layers) const
{
  const Index from = std::max(layers.from, nodes_.lower()[Dim - 1]), to = std::min(layers.to, nodes_.upper()[Dim - 1]);
  const auto wide = static_cast<std::size_t>(nodes_.view().step[Dim - 1]);
  if (from > to) return {0, 0};
  return {static_cast<std::size_t>(from - nodes_.lower()[Dim - 1]) * wide,
          static_cast<std::size_t>(to - from + 1) * wide};
}

/// visit(body, blocks)
template <int Dim> template <class Visit> void GridMotion<Dim>::for_each_inner(Index layer, Visit&& visit) const
{
  for (std::size_t b = 0; b < points_.size(); ++b) {
    const Index low = points_[b].lowest()[Dim - 1];
    if (layer < low || layer - low >= static_cast<Index>(inner_[b].size())) continue;
    for (const SomeBlocks& blocks : inner_[b][static_cast<std::size_t>(layer - low)]) visit(b, blocks);
  }
}

template <int Dim> void GridMotion<Dim>::take_from(std::size_t body, Taking what, const SomeBlocks& blocks)
{
  what.blocks = blocks;
  work_ += push_[body].dot(take<Dim>(processor_, rule_, bodies_[body], what, points_[body], nodes_.view()));
}

template <int Dim> void GridMotion<Dim>::musl_step(double end, double length, double kick)
{
  static Event event("mpm_musl");
  const Timed timed(event);
  const auto [first, count] = grid_musl::reach_of(rule_.shape);
  const NodeView<Dim>& view = nodes_.view();
  const Taking move{.velocity = true, .giving = true, .place = !rule_.late, .step = length, .kick = kick},
      strain{.strain = true, .place = rule_.late, .brought = true, .step = length};
  const auto gives = [&](std::size_t b, const SomeBlocks& blocks) {
    const Giving all{.momentum = true, .force = true, .blocks = blocks};
    give<Dim>(processor_, rule_, bodies_[b], all, push_[b], points_[b], view);
  };
  std::vector<double*> sums{view.mass};
  sums.insert(sums.end(), view.velocity.begin(), view.velocity.end());
  sums.insert(sums.end(), view.pull.begin(), view.pull.end());
  const auto clear = [&](const Layers& layers) {
    const auto [at, nodes] = nodes_of(layers);
    for (double* list : sums) std::fill_n(list + at, nodes, 0.0);
    for (double* list : view.brought) std::fill_n(list + at, nodes, 0.0);
  };
  const bool alone = !nodes_.is_shared(nodes_.lower(), nodes_.upper());
  if (!alone) clear({});
  for (std::size_t b = 0; b < border_.size(); ++b)
    for (const SomeBlocks& blocks : border_[b]) gives(b, blocks);
  nodes_.add_up(sums);

  const Index low = nodes_.lower()[Dim - 1], high = nodes_.upper()[Dim - 1], behind = count - 1;
  if (alone) clear({low, low + first + count - 2});
  for (Index layer = low; layer <= high + 2 * behind - first; ++layer) {
    if (alone) clear({layer + first + count - 1, layer + first + count - 1});
    for_each_inner(layer, gives);
    const Layers whole{layer + first, layer + first}, come{whole.from - behind, whole.from - behind};
    if (const auto [at, nodes] = nodes_of(whole); nodes > 0) {
      for (std::size_t d = 0; d < Dim; ++d)
        settle_nodes(processor_, nodes_.mass().subspan(at, nodes), point_mass_, kick, view.velocity[d] + at,
                     view.pull[d] + at, false, true);
      hold_nodes(end, kick, true, false, whole);
    }
    for (std::size_t b = 0; b < points_.size(); ++b)
      if (const SomeBlocks blocks = layer_of(b, layer - behind); blocks.to > 0) take_from(b, move, blocks);
    if (const auto [at, nodes] = nodes_of(come); nodes > 0) {
      for (double* list : view.brought)
        settle_nodes(processor_, nodes_.mass().subspan(at, nodes), point_mass_, 0.0, list + at, nullptr);
      hold_nodes(end, kick, false, true, come);
    }
    for_each_inner(layer - 2 * behind, [&](std::size_t b, const SomeBlocks& blocks) { take_from(b, strain, blocks); });
  }
  if (alone) return;
  nodes_.add_up(view.brought); // shares of a velocity: they were divided by the mass that all have together
  hold_nodes(end, kick, false, true);
  for (std::size_t b = 0; b < border_.size(); ++b)
    for (const SomeBlocks& blocks : border_[b]) take_from(b, strain, blocks);
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template SomeBlocks GridMotion<Dim>::layer_of(std::size_t, Index) const;                                             \
  template bool GridMotion<Dim>::find_seen();                                                                          \
  template void GridMotion<Dim>::find_borders();                                                                       \
  template std::pair<std::size_t, std::size_t> GridMotion<Dim>::nodes_of(const Layers&) const;                         \
  template void GridMotion<Dim>::take_from(std::size_t, Taking, const SomeBlocks&);                                    \
  template void GridMotion<Dim>::musl_step(double, double, double)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::mpm
