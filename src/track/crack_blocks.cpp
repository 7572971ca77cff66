#include "crack_blocks.hpp"

#include "lattice_units.hpp"

#include <set>

namespace pdx::track {
namespace {
/// Sites [lower, upper).
struct SiteBlock {
  Site<2> lower, upper;
};

bool is_full(const BondGraph& graph, const SiteBlock& block)
{
  for (Index j = block.lower[1]; j < block.upper[1]; ++j)
    for (Index i = block.lower[0]; i < block.upper[0]; ++i)
      if (!graph.has({i, j})) return false;
  return true;
}

/// The block, or the largest quarters of it that are full of particles.
void add_full(const BondGraph& graph, const SiteBlock& block, std::vector<geom::Box<2>>& boxes)
{
  const auto& [lower, upper] = block;
  if (lower[0] >= upper[0] || lower[1] >= upper[1]) return;
  if (is_full(graph, block)) {
    boxes.push_back(in_metres(graph.lattice(), CellBox{{lower[0], lower[1]}, {upper[0], upper[1]}}));
    return;
  }
  if (upper[0] - lower[0] == 1 && upper[1] - lower[1] == 1) return;
  const Site<2> middle{(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2};
  add_full(graph, {lower, middle}, boxes);
  add_full(graph, {{middle[0], lower[1]}, {upper[0], middle[1]}}, boxes);
  add_full(graph, {{lower[0], middle[1]}, {middle[0], upper[1]}}, boxes);
  add_full(graph, {middle, upper}, boxes);
}
} // namespace

std::vector<geom::Box<2>> crack_blocks(const BondGraph& graph, std::span<const Site<2>> damaged)
{
  const auto width = static_cast<Index>(std::ceil(graph.horizon() / graph.lattice().dx)) + 1;
  const auto block_of = [width](const Site<2>& site) {
    const auto down = [width](Index i) { return (i >= 0 ? i : i - width + 1) / width; };
    return Site<2>{down(site[0]), down(site[1])};
  };
  std::set<Site<2>> blocks;
  for (const Site<2>& site : damaged)
    for (std::size_t h = 0; h < graph.stencil().half.size(); ++h) {
      if (!graph.gone(site, h)) continue;
      const Site<2> a = block_of(site), b = block_of(graph.end_of(site, h));
      for (Index j = std::min(a[1], b[1]) - 1; j <= std::max(a[1], b[1]) + 1; ++j) // and those that a path may clip
        for (Index i = std::min(a[0], b[0]) - 1; i <= std::max(a[0], b[0]) + 1; ++i) blocks.insert({i, j});
    }
  std::vector<geom::Box<2>> boxes;
  for (const auto& [i, j] : blocks)
    add_full(graph, {{i * width, j * width}, {(i + 1) * width, (j + 1) * width}}, boxes);
  return boxes;
}
} // namespace pdx::track
