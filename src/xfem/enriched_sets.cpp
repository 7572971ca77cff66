#include "pdx/xfem/enriched_sets.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/crack/cut_cells.hpp"
#include "pdx/mesh/vertex_halo.hpp"

#include <fmt/format.h>
#include <limits>

namespace pdx::xfem {
namespace {
constexpr double kTolerance = 1e-9; // of the smallest edge

double smallest_edge(const mesh::Mesh& mesh)
{
  double squared = std::numeric_limits<double>::max();
  for (Index c = 0; c < mesh.cells(); ++c) {
    const auto x = mesh.corners(c);
    for (std::size_t k = 0; k < 4; ++k) squared = std::min(squared, (x[(k + 1) % 4] - x[k]).squaredNorm());
  }
  MPI_Allreduce(MPI_IN_PLACE, &squared, 1, MPI_DOUBLE, MPI_MIN, mesh.comm());
  return std::sqrt(squared);
}

/// What all cracks do to the elements of this rank.
struct Found {
  std::vector<CellCut> cuts;     ///< ascending by cell
  std::vector<std::size_t> tips; ///< numbers of the tips that lie in owned elements
  std::vector<std::size_t> ends; ///< numbers of the junctions that do
};

/// Is x in the cell, grown by `margin` on every side?
bool holds(const fem::Corners& corners, const Vector<2>& x, double margin)
{
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector<2> along = (corners[(k + 1) % 4] - corners[k]).normalized(), to = x - corners[k];
    if (along.x() * to.y() - along.y() * to.x() < -margin) return false;
  }
  return true;
}

/// Adds the numbers of the ends of a crack, tips or junctions, that lie in the cell.
template <class End>
void add_ends_in(const fem::Corners& cell, double margin, int crack, std::span<const End> ends,
                 std::vector<std::size_t>& found)
{
  for (std::size_t k = 0; k < ends.size(); ++k)
    if (ends[k].crack == crack && holds(cell, ends[k].at, margin)) found.push_back(k);
}

Found find_everything(const mesh::Mesh& mesh, const crack::CrackSet& cracks)
{
  Found found;
  const double tolerance = kTolerance * smallest_edge(mesh);
  for (int crack = 0; crack < cracks.size(); ++crack) {
    const crack::Cuts cuts = crack::find_cuts(cracks, crack, {mesh.points(), mesh.all_cells()}, tolerance);
    for (const crack::CutCell& cut : cuts.cells) {
      if (mesh.use(cut.cell) == mesh::Use::covered || mesh.use(cut.cell) == mesh::Use::points) continue;
      if (cut.kind == crack::CellKind::through) {
        CellCut& kept = found.cuts.emplace_back(CellCut{cut.cell, crack, {}});
        for (std::size_t a = 0; a < 4; ++a)
          kept.distance[a] = cuts.distance[static_cast<std::size_t>(mesh.cell(cut.cell)[a])];
      } else if (cut.cell < mesh.owned_cells()) {
        const fem::Corners corners = mesh.corners(cut.cell);
        // A tip just before an edge lies in the next cell: within the tolerance, and its rounding.
        add_ends_in(corners, 2.0 * tolerance, crack, cracks.tips(), found.tips);
        add_ends_in(corners, tolerance, crack, cracks.junctions(), found.ends);
      }
    }
  }
  std::ranges::stable_sort(found.cuts, {}, &CellCut::cell);
  return found;
}

/// A cell that two cracks cut.
struct Junction {
  Index natural;
  std::array<int, 2> cracks;
  std::array<double, 2> at; ///< [m]
};

std::vector<Junction> owned_junctions(const mesh::Mesh& mesh, std::span<const CellCut> cuts)
{
  std::vector<Junction> mine;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (cuts[i].cell != cuts[i + 1].cell || cuts[i].cell >= mesh.owned_cells()) continue;
    const Vector<2> x = mesh.centroid(cuts[i].cell);
    mine.push_back({mesh.natural_cell(cuts[i].cell), {cuts[i].crack, cuts[i + 1].crack}, {x.x(), x.y()}});
  }
  return mine;
}

/// Refuses the first cell that two cracks cut, alike on every rank. Collective.
void refuse_junctions(const mesh::Mesh& mesh, std::span<const CellCut> cuts, const geom::Frame& frame)
{
  const std::vector<Junction> all = gather_all(mesh.comm(), owned_junctions(mesh, cuts));
  if (all.empty()) return;
  const Junction first = *std::ranges::min_element(
      all, {}, [](const Junction& j) { return std::tuple(j.natural, j.cracks[0], j.cracks[1]); });
  throw UserError(
      fmt::format("cracks {} and {} cut the same element, around {}; an element opens along one crack: refine the "
                  "mesh, move them apart, or put a patch there",
                  first.cracks[0] + 1, first.cracks[1] + 1, frame.text({first.at[0], first.at[1]})));
}

/// Those of one crack, of supports sorted by crack.
template <class Support> std::span<Support> of_crack(std::span<Support> supports, int crack)
{
  const auto first = std::ranges::lower_bound(supports, crack, {}, &NodeSupport::crack);
  return {first, std::ranges::upper_bound(first, supports.end(), crack, {}, &NodeSupport::crack)};
}

/// Verdicts and leans of nodes of other ranks, from the ranks that see their whole support. Collective.
void take_owners_verdicts(const mesh::Mesh& mesh, int cracks, std::span<NodeSupport> supports)
{
  std::vector<int> code(static_cast<std::size_t>(mesh.vertices())); // 2 verdict + lean
  for (int crack = 0; crack < cracks; ++crack) {
    const std::span<NodeSupport> own = of_crack(supports, crack);
    for (const NodeSupport& s : own)
      code[static_cast<std::size_t>(s.node)] = 2 * static_cast<int>(s.verdict) + static_cast<int>(s.lean);
    mesh::fill_halo(mesh, MPI_INT, 1, code.data());
    for (NodeSupport& s : own) {
      s.verdict = static_cast<Verdict>(code[static_cast<std::size_t>(s.node)] / 2);
      s.lean = static_cast<Side>(code[static_cast<std::size_t>(s.node)] % 2);
    }
  }
}

/// `xfem::enrich` on a distributed mesh. Collective.
Enrichment enrich_together(const mesh::Mesh& mesh, const MeshView& view, std::span<const CellCut> cuts,
                           const EnrichmentRule& rule, int cracks)
{
  Snaps snapped(cuts.size());
  while (true) {
    std::vector<NodeSupport> supports = measure(view, cuts, snapped, rule.quadrature);
    judge(supports, rule.share());
    take_owners_verdicts(mesh, cracks, supports);
    const bool moved = snap(view, cuts, supports, snapped);
    if (!any_rank(mesh.comm(), moved)) return collect(supports, std::move(snapped));
  }
}

/// Refuses the first crack that ends on another inside an element, where it closes at an edge before. Collective.
void refuse_ends(const mesh::Mesh& mesh, const crack::CrackSet& cracks, const std::vector<std::size_t>& mine,
                 const geom::Frame& frame)
{
  const std::vector<std::size_t> all = gather_all(mesh.comm(), mine);
  if (all.empty()) return;
  const crack::Junction& first = cracks.junctions()[*std::ranges::min_element(all)];
  throw UserError(
      fmt::format("crack {} ends on crack {} inside an element, {}; an element opens along one crack: give one line "
                  "through both, or put a patch there",
                  first.crack + 1, first.other + 1, frame.text(first.at)));
}

std::vector<Vector<2>> closed_tips(const mesh::Mesh& mesh, const crack::CrackSet& cracks,
                                   const std::vector<std::size_t>& mine)
{
  std::vector<std::size_t> all = gather_all(mesh.comm(), mine);
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<Vector<2>> places;
  for (const std::size_t t : all) places.push_back(cracks.tips()[t].at);
  return places;
}
} // namespace

EnrichedSets::EnrichedSets(mesh::Mesh& mesh, const crack::CrackSet& cracks, const EnrichmentRule& rule,
                           const geom::Frame& frame)
    : mesh_(mesh), cracks_(cracks)
{
  const Found found = find_everything(mesh, cracks);
  refuse_junctions(mesh, found.cuts, frame);
  refuse_ends(mesh, cracks, found.ends, frame);
  std::vector<Index> active;
  for (Index c = 0; c < mesh.cells(); ++c)
    if (mesh.use(c) != mesh::Use::covered && mesh.use(c) != mesh::Use::points) active.push_back(c);
  const MeshView view{mesh.all_cells(), mesh.points(), active};
  const Enrichment enrichment = enrich_together(mesh, view, found.cuts, rule, cracks.size());
  keep_sets(enrichment);
  keep_cells(view, found.cuts, enrichment, rule.quadrature);
  for (const CutElement& cut : cells_) mesh.cut(cut.cell);
  count(enrichment);
  report_.closed = closed_tips(mesh, cracks, found.tips);
}

void EnrichedSets::keep_sets(const Enrichment& enrichment)
{
  const auto vertices = static_cast<std::size_t>(mesh_.vertices());
  std::vector<std::pair<Index, EnrichedSet>> all;
  std::vector<int> side(vertices); // of a set, -1 for none
  for (int crack = 0; crack < cracks_.size(); ++crack) {
    std::ranges::fill(side, -1);
    for (const NodeSupport& s : of_crack(std::span(enrichment.nodes), crack))
      side[static_cast<std::size_t>(s.node)] = static_cast<int>(s.side);
    mesh::fill_halo(mesh_, MPI_INT, 1, side.data());
    for (std::size_t v = 0; v < vertices; ++v)
      if (side[v] >= 0) all.emplace_back(static_cast<Index>(v), EnrichedSet{crack, -1, static_cast<Side>(side[v])});
  }
  std::ranges::stable_sort(all, {}, [](const auto& entry) { return entry.first; });
  offsets_.assign(vertices + 1, 0);
  for (const auto& [vertex, set] : all) {
    ++offsets_[static_cast<std::size_t>(vertex) + 1];
    sets_.push_back(set);
    if (vertex < mesh_.owned_vertices()) vertices_.push_back(vertex);
  }
  for (std::size_t v = 0; v < vertices; ++v) offsets_[v + 1] += offsets_[v];
}

void EnrichedSets::keep_cells(const MeshView& view, std::span<const CellCut> cuts, const Enrichment& enrichment,
                              Quadrature quadrature)
{
  cells_.reserve(cuts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i)
    cells_.push_back({.cell = cuts[i].cell,
                      .crack = cuts[i].crack,
                      .snapped = enrichment.snapped[i],
                      .distance = cuts[i].distance,
                      .element = enriched_element(view, cuts, i, enrichment, quadrature)});
}

void EnrichedSets::count(const Enrichment& enrichment)
{
  const auto owned_cell = [&](const CutElement& cut) { return cut.cell < mesh_.owned_cells(); };
  const auto lost = [&](const NodeSupport& s) {
    return s.verdict == Verdict::share && s.node < mesh_.owned_vertices();
  };
  std::array<Index, 3> sum{static_cast<Index>(std::ranges::count_if(cells_, owned_cell)), owned(),
                           static_cast<Index>(std::ranges::count_if(enrichment.dropped, lost))};
  MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_INT, MPI_SUM, mesh_.comm());
  report_ = {sum[0], sum[1], sum[2], {}};
}

EnrichedSet* EnrichedSets::find(Index vertex, int crack)
{
  for (std::size_t k = offsets_[static_cast<std::size_t>(vertex)]; k < offsets_[static_cast<std::size_t>(vertex) + 1];
       ++k)
    if (sets_[k].crack == crack) return &sets_[k];
  return nullptr;
}

void EnrichedSets::number(PetscInt first)
{
  for (std::size_t k = 0; k < vertices_.size(); ++k) sets_[k].row = first + static_cast<PetscInt>(k);
  std::vector<PetscInt> rows(static_cast<std::size_t>(mesh_.vertices()));
  for (int crack = 0; crack < cracks_.size(); ++crack) {
    std::ranges::fill(rows, -1);
    for (const Index v : vertices_)
      if (const EnrichedSet* set = find(v, crack)) rows[static_cast<std::size_t>(v)] = set->row;
    mesh::fill_halo(mesh_, MPIU_INT, 1, rows.data());
    for (Index v = mesh_.owned_vertices(); v < mesh_.vertices(); ++v)
      if (EnrichedSet* set = find(v, crack)) set->row = rows[static_cast<std::size_t>(v)];
  }
  for (CutElement& cut : cells_)
    for (std::size_t a = 0; a < 4; ++a)
      if (cut.element.enriched[a]) cut.sets[a] = find(mesh_.cell(cut.cell)[a], cut.crack)->row;
}

std::span<const EnrichedSet> EnrichedSets::of(Index vertex) const
{
  const std::size_t begin = offsets_[static_cast<std::size_t>(vertex)];
  return {sets_.data() + begin, offsets_[static_cast<std::size_t>(vertex) + 1] - begin};
}

const CutElement* EnrichedSets::cut(Index cell) const
{
  const auto at = std::ranges::lower_bound(cells_, cell, {}, &CutElement::cell);
  return at != cells_.end() && at->cell == cell ? &*at : nullptr;
}

Side EnrichedSets::side_in(const CutElement& cut, const Vector<2>& x) const
{
  if (cut.snapped) return *cut.snapped;
  return cracks_.side(cut.crack, x) > 0 ? Side::plus : Side::minus;
}
} // namespace pdx::xfem
