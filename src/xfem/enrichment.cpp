#include "pdx/xfem/enrichment.hpp"

#include "pdx/base/error.hpp"
#include "pdx/geom/polygon.hpp"

#include <tuple>
#include <utility>

namespace pdx::xfem {
namespace {
using Key = std::pair<int, Index>; // crack, node

Key key_of(const NodeSupport& support) { return {support.crack, support.node}; }

/// The support of a node, or nullptr.
template <class Supports> auto* find(Supports& supports, const Key& key)
{
  const auto at = std::ranges::lower_bound(supports, key, {}, key_of);
  return at != supports.end() && key_of(*at) == key ? &*at : nullptr;
}

const std::array<Index, 4>& cell_of(const MeshView& view, Index cell)
{
  return view.cells[static_cast<std::size_t>(cell)];
}

/// All nodes of cut cells, without areas.
std::vector<NodeSupport> nodes_of(const MeshView& view, std::span<const CellCut> cuts)
{
  std::vector<NodeSupport> supports;
  supports.reserve(4 * cuts.size());
  for (const CellCut& cut : cuts)
    for (std::size_t a = 0; a < 4; ++a)
      supports.push_back({.crack = cut.crack,
                          .node = cell_of(view, cut.cell)[a],
                          .side = side_of(cut.distance[a]),
                          .area = {},
                          .verdict = Verdict::enriched,
                          .lean = Side::plus});
  std::ranges::sort(supports, {}, key_of);
  const auto same = [](const NodeSupport& a, const NodeSupport& b) {
    PDX_ASSERT(key_of(a) != key_of(b) || a.side == b.side);
    return key_of(a) == key_of(b);
  };
  supports.erase(std::unique(supports.begin(), supports.end(), same), supports.end());
  return supports;
}

/// A cell that the crack does not cut: on the side of its nodes; on both sides it holds the tip.
void add_uncut(double area, const std::array<NodeSupport*, 4>& corner)
{
  for (std::size_t a = 0; a < 4; ++a) {
    NodeSupport* here = corner[a];
    NodeSupport* next = corner[(a + 1) % 4];
    if (here) here->area[here->side] += area;
    if (here && next && here->side != next->side) here->verdict = next->verdict = Verdict::tip;
  }
}

/// Adds the active cells next to cut ones.
void add_uncut_cells(const MeshView& view, std::span<const CellCut> cuts, std::vector<NodeSupport>& supports)
{
  std::vector<bool> touched(view.points.size());
  std::vector<int> cracks;
  for (const NodeSupport& support : supports) {
    touched[static_cast<std::size_t>(support.node)] = true;
    if (cracks.empty() || cracks.back() != support.crack) cracks.push_back(support.crack);
  }
  std::vector<Key> cut; // crack, cell
  for (const CellCut& c : cuts) cut.emplace_back(c.crack, c.cell);
  std::ranges::sort(cut);

  for (const Index c : view.active) {
    const auto& nodes = cell_of(view, c);
    if (std::ranges::none_of(nodes, [&](Index n) { return touched[static_cast<std::size_t>(n)]; })) continue;
    for (const int crack : cracks) {
      if (std::ranges::binary_search(cut, Key{crack, c})) continue;
      std::array<NodeSupport*, 4> corner;
      for (std::size_t a = 0; a < 4; ++a) corner[a] = find(supports, Key{crack, nodes[a]});
      add_uncut(geom::area(view.corners(c)), corner);
    }
  }
}
} // namespace

fem::Corners MeshView::corners(Index cell) const
{
  fem::Corners corners;
  for (std::size_t a = 0; a < 4; ++a) corners[a] = points[static_cast<std::size_t>(cell_of(*this, cell)[a])];
  return corners;
}

std::vector<NodeSupport> measure(const MeshView& view, std::span<const CellCut> cuts, const Snaps& snapped,
                                 Quadrature quadrature)
{
  std::vector<NodeSupport> supports = nodes_of(view, cuts);
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const fem::Corners corners = view.corners(cuts[i].cell);
    SideAreas areas;
    if (snapped[i])
      areas[*snapped[i]] = geom::area(corners);
    else
      areas = side_areas(corners, cuts[i].distance, quadrature);
    for (const Index node : cell_of(view, cuts[i].cell))
      for (const Side side : kSides) find(supports, Key{cuts[i].crack, node})->area[side] += areas[side];
  }
  add_uncut_cells(view, cuts, supports);
  return supports;
}

void judge(std::span<NodeSupport> supports, double least_share)
{
  for (NodeSupport& support : supports) {
    if (support.verdict == Verdict::tip) continue;
    support.lean = support.area[Side::plus] >= support.area[Side::minus] ? Side::plus : Side::minus;
    if (support.area.share(opposite(support.lean)) < least_share) support.verdict = Verdict::share;
  }
}

bool snap(const MeshView& view, std::span<const CellCut> cuts, std::span<const NodeSupport> supports, Snaps& snapped)
{
  bool any = false;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    if (snapped[i]) continue;
    std::array<bool, 2> wanted{}; // by side
    for (const Index node : cell_of(view, cuts[i].cell)) {
      const NodeSupport* support = find(supports, Key{cuts[i].crack, node});
      if (support->verdict == Verdict::share) wanted[static_cast<std::size_t>(support->lean)] = true;
    }
    if (!wanted[0] && !wanted[1]) continue;
    snapped[i] = wanted[1] ? Side::plus : Side::minus;
    if (wanted[0] && wanted[1]) { // a cell much smaller than its neighbours: its larger part decides
      const SideAreas areas = side_areas(view.corners(cuts[i].cell), cuts[i].distance, Quadrature::polygons);
      snapped[i] = areas[Side::plus] >= areas[Side::minus] ? Side::plus : Side::minus;
    }
    any = true;
  }
  return any;
}

Enrichment collect(std::span<const NodeSupport> supports, Snaps snapped)
{
  Enrichment result;
  for (const NodeSupport& support : supports)
    (support.verdict == Verdict::enriched ? result.nodes : result.dropped).push_back(support);
  result.snapped = std::move(snapped);
  return result;
}

Enrichment enrich(const MeshView& view, std::span<const CellCut> cuts, const EnrichmentRule& rule, Snaps snapped)
{
  snapped.resize(cuts.size());
  while (true) {
    std::vector<NodeSupport> supports = measure(view, cuts, snapped, rule.quadrature);
    judge(supports, rule.share());
    if (!snap(view, cuts, supports, snapped)) return collect(supports, std::move(snapped));
  }
}

std::optional<Index> cell_of_two_cracks(std::span<const CellCut> cuts)
{
  std::vector<Index> cells;
  for (const CellCut& cut : cuts) cells.push_back(cut.cell);
  std::ranges::sort(cells);
  const auto twice = std::ranges::adjacent_find(cells);
  return twice == cells.end() ? std::nullopt : std::optional(*twice);
}

std::array<Index, 4> sets_of(const MeshView& view, const CellCut& cut, const Enrichment& enrichment)
{
  std::array<Index, 4> sets;
  for (std::size_t a = 0; a < 4; ++a) {
    const NodeSupport* support = find(enrichment.nodes, Key{cut.crack, cell_of(view, cut.cell)[a]});
    sets[a] = support ? static_cast<Index>(support - enrichment.nodes.data()) : -1;
  }
  return sets;
}

EnrichedElement enriched_element(const MeshView& view, std::span<const CellCut> cuts, std::size_t cut,
                                 const Enrichment& enrichment, Quadrature quadrature)
{
  EnrichedElement element;
  const fem::Corners corners = view.corners(cuts[cut].cell);
  const std::optional<Side> whole = enrichment.snapped[cut];
  element.cell = whole ? whole_cell(corners, *whole) : cut_cell(corners, cuts[cut].distance, quadrature);
  const std::array<Index, 4> sets = sets_of(view, cuts[cut], enrichment);
  for (std::size_t a = 0; a < 4; ++a) {
    element.side[a] = side_of(cuts[cut].distance[a]);
    element.enriched[a] = sets[a] >= 0;
  }
  return element;
}
} // namespace pdx::xfem
