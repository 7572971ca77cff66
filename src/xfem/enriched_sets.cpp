#include "pdx/xfem/enriched_sets.hpp"

#include "junction_zone.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/base/run_of.hpp"
#include "pdx/crack/cut_cells.hpp"
#include "pdx/mesh/vertex_halo.hpp"

#include <fmt/format.h>

namespace pdx::xfem {
namespace {
constexpr double kTolerance = 1e-9; // of the smallest edge
constexpr double kFar = 1e-2;       // of the mesh: what a crack goes on for at its ends, and more

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
  std::vector<NearCell> near;    ///< owned elements that cracks may reach, ascending by cell
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

/// How far a point is beyond the sides of a convex outline; below 0 inside [m].
double how_far_out(const geom::Polygon& outline, const Vector<2>& x)
{
  double out = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector<2> along = outline[(k + 1) % outline.size()] - outline[k], to = x - outline[k];
    if (const double length = along.norm(); length > 0.0)
      out = std::max(out, (to.x() * along.y() - to.y() * along.x()) / length);
  }
  return out;
}

/// Adds the numbers of the tips of a crack that lie in the cell.
void add_tips_in(const fem::Corners& cell, double margin, int crack, std::span<const crack::Tip> tips,
                 std::vector<std::size_t>& found)
{
  for (std::size_t k = 0; k < tips.size(); ++k)
    if (tips[k].crack == crack && holds(cell, tips[k].at, margin)) found.push_back(k);
}

/// Of all local cells [m].
double longest_diagonal(const mesh::Mesh& mesh)
{
  double squared = 0.0;
  for (Index c = 0; c < mesh.cells(); ++c) {
    const auto x = mesh.corners(c);
    squared = std::max({squared, (x[2] - x[0]).squaredNorm(), (x[3] - x[1]).squaredNorm()});
  }
  return std::sqrt(squared);
}

/// The cells that may lie at a crack, and their vertices: a small mesh of its own.
struct CellsAtCrack {
  std::vector<Index> cells;                  ///< of the mesh, ascending
  std::vector<std::array<Index, 4>> corners; ///< of each, among `points`
  std::vector<Vector<2>> points;

  CellsAtCrack(const mesh::Mesh& mesh, const crack::Polyline& crack)
  {
    const double margin = kFar * mesh.bounds().size().norm();
    geom::Box<2> box{crack.front(), crack.front()};
    for (const Vector<2>& x : crack) box = {box.lower.cwiseMin(x), box.upper.cwiseMax(x)};
    std::vector<std::uint8_t> beyond; // per vertex, a bit for each side of the box that it is beyond
    beyond.reserve(mesh.points().size());
    for (const Vector<2>& x : mesh.points())
      beyond.push_back(
          static_cast<std::uint8_t>(int{x[0] < box.lower[0] - margin} | int{x[0] > box.upper[0] + margin} << 1 |
                                    int{x[1] < box.lower[1] - margin} << 2 | int{x[1] > box.upper[1] + margin} << 3));
    std::vector<Index> number(mesh.points().size(), -1);
    for (Index c = 0; c < mesh.cells(); ++c) {
      const auto& cell = mesh.cell(c);
      const auto at = [&](std::size_t a) { return beyond[static_cast<std::size_t>(cell[a])]; };
      if (at(0) & at(1) & at(2) & at(3)) continue; // all of it is
      cells.push_back(c);
      auto& own = corners.emplace_back();
      for (std::size_t a = 0; a < 4; ++a) {
        Index& k = number[static_cast<std::size_t>(cell[a])];
        if (k < 0) {
          k = static_cast<Index>(points.size());
          points.push_back(mesh.point(cell[a]));
        }
        own[a] = k;
      }
    }
  }
};

Found find_everything(const mesh::Mesh& mesh, const crack::CrackSet& cracks, double tolerance)
{
  Found found;
  const double reach = longest_diagonal(mesh) + tolerance;
  for (int crack = 0; crack < cracks.size(); ++crack) {
    const CellsAtCrack near(mesh, cracks.points(crack));
    const crack::Cuts cuts = crack::find_cuts(cracks, crack, {near.points, near.corners}, tolerance);
    for (const crack::CutCell& nearby : cuts.cells) {
      const crack::CutCell cut{near.cells[static_cast<std::size_t>(nearby.cell)], nearby.kind, nearby.edges};
      if (!is_element(mesh, cut.cell)) continue;
      std::array<double, 4> distance{}; // of its corners
      for (std::size_t a = 0; a < 4; ++a)
        distance[a] = cuts.distance[static_cast<std::size_t>(near.corners[static_cast<std::size_t>(nearby.cell)][a])];
      if (cut.kind == crack::CellKind::through) {
        CellCut& kept = found.cuts.emplace_back(CellCut{cut.cell, crack, {}});
        kept.distance = distance;
        continue;
      }
      // A tip just before an edge lies in the next cell: within the tolerance, and its rounding.
      if (cut.cell < mesh.owned_cells())
        add_tips_in(mesh.corners(cut.cell), 2.0 * tolerance, crack, cracks.tips(), found.tips);
    }
    for (std::size_t k = 0; k < near.cells.size(); ++k)
      if (const Index c = near.cells[k]; c < mesh.owned_cells() && is_element(mesh, c) &&
                                         std::abs(cuts.distance[static_cast<std::size_t>(near.corners[k][0])]) <= reach)
        found.near.push_back({c, crack});
  }
  std::ranges::stable_sort(found.near, {}, &NearCell::cell);
  std::ranges::stable_sort(found.cuts, {}, &CellCut::cell);
  return found;
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
                           const EnrichmentRule& rule, int cracks, Snaps snapped)
{
  while (true) {
    std::vector<NodeSupport> supports = measure(view, cuts, snapped, rule.quadrature);
    judge(supports, rule.share());
    take_owners_verdicts(mesh, cracks, supports);
    const bool moved = snap(view, cuts, supports, snapped);
    if (!any_rank(mesh.comm(), moved)) return collect(supports, std::move(snapped));
  }
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
    : mesh_(mesh), cracks_(&cracks)
{
  const double tolerance = kTolerance * smallest_edge(mesh);
  const Found found = find_everything(mesh, cracks, tolerance);
  std::vector<Index> active;
  for (Index c = 0; c < mesh.cells(); ++c)
    if (is_element(mesh, c)) active.push_back(c);
  const MeshView view{mesh.all_cells(), mesh.points(), active};
  JunctionZone zone(mesh, cracks, view, found.near, found.cuts, tolerance, frame);
  Snaps snapped(found.cuts.size());
  Enrichment enrichment;
  do {
    enrichment = enrich_together(mesh, view, found.cuts, rule, cracks.size(), snapped);
    snapped = enrichment.snapped;
    if (!zone.empty()) zone.part(found.cuts, snapped, rule.share());
  } while (!zone.empty() && any_rank(mesh.comm(), zone.snap(view, found.cuts, snapped)));
  codes_ = zone.codes();
  keep_sets(enrichment, zone);
  keep_cells(view, found.cuts, enrichment, rule.quadrature, zone);
  for (std::size_t k = 0; k < cells_.size(); ++k)
    if (k == 0 || cells_[k].cell != cells_[k - 1].cell) mesh.cut(cells_[k].cell);
  count(enrichment, zone);
  report_.closed = closed_tips(mesh, cracks, found.tips);
}

void EnrichedSets::keep_sets(const Enrichment& enrichment, const JunctionZone& zone)
{
  const auto vertices = static_cast<std::size_t>(mesh_.vertices());
  std::vector<std::pair<Index, EnrichedSet>> all;
  std::vector<int> side(vertices); // of a set, -1 for none
  for (int crack = 0; crack < cracks_->size(); ++crack) {
    std::ranges::fill(side, -1);
    for (const NodeSupport& s : of_crack(std::span(enrichment.nodes), crack))
      side[static_cast<std::size_t>(s.node)] = static_cast<int>(s.side);
    mesh::fill_halo(mesh_, MPI_INT, 1, side.data());
    for (std::size_t v = 0; v < vertices; ++v)
      if (side[v] >= 0 && (zone.empty() || !zone.has_node(static_cast<Index>(v))))
        all.emplace_back(static_cast<Index>(v), EnrichedSet{crack, -1, static_cast<Side>(side[v]), {}});
  }
  for (Index v = 0; v < mesh_.vertices() && !zone.empty(); ++v)
    if (zone.has_node(v))
      for (const NodeCopy& copy : zone.copies(v).copies)
        all.emplace_back(v, EnrichedSet{copy.code, -1, copy.side, copy.at});
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
                              Quadrature quadrature, const JunctionZone& zone)
{
  cells_.reserve(cuts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i)
    if (!zone.has_cell(cuts[i].cell))
      cells_.push_back({.cell = cuts[i].cell,
                        .crack = cuts[i].crack,
                        .snapped = enrichment.snapped[i],
                        .distance = cuts[i].distance,
                        .element = enriched_element(view, cuts, i, enrichment, quadrature)});
  if (!zone.empty()) keep_pieces(zone, cuts);
}

/// Pieces of cells, each an element of its own.
void EnrichedSets::keep_pieces(const JunctionZone& zone, std::span<const CellCut> cuts)
{
  for (Index c = 0; c < mesh_.cells(); ++c) {
    if (!zone.has_cell(c)) continue;
    const auto of_cell = run_of(cuts, c, &CellCut::cell);
    for (const Piece& piece : zone.pieces(c)) {
      CutElement cut{.cell = c, .crack = 0, .snapped = {}, .distance = {}, .element = {}};
      if (!of_cell.empty()) {
        cut.crack = of_cell.front().crack;
        cut.distance = of_cell.front().distance;
      }
      if (zone.pieces(c).size() == 1) cut.snapped = piece.side;
      std::array<double, 4> factor{};
      for (std::size_t a = 0; a < 4; ++a)
        if (const EnrichedSet* set = piece.set[a] < 0 ? nullptr : find(mesh_.cell(c)[a], piece.set[a]))
          factor[a] = shifted_step(opposite(set->side), set->side);
      cut.element = piece_element(mesh_.corners(c), piece, factor);
      cut.piece = piece;
      cells_.push_back(std::move(cut));
    }
  }
  std::ranges::stable_sort(cells_, {}, &CutElement::cell);
}

void EnrichedSets::count(const Enrichment& enrichment, const JunctionZone& zone)
{
  Index owned_cells = 0, given_up = 0;
  for (std::size_t k = 0; k < cells_.size(); ++k)
    owned_cells += cells_[k].cell < mesh_.owned_cells() && (k == 0 || cells_[k].cell != cells_[k - 1].cell);
  for (Index v = 0; v < mesh_.owned_vertices() && !zone.empty(); ++v)
    if (zone.has_node(v)) given_up += zone.copies(v).lost;
  const auto lost = [&](const NodeSupport& s) {
    return s.verdict == Verdict::share && s.node < mesh_.owned_vertices();
  };
  std::array<Index, 3> sum{owned_cells, owned(),
                           given_up + static_cast<Index>(std::ranges::count_if(enrichment.dropped, lost))};
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
  for (int crack = 0; crack < codes_; ++crack) {
    std::ranges::fill(rows, -1);
    for (const Index v : vertices_)
      if (const EnrichedSet* set = find(v, crack)) rows[static_cast<std::size_t>(v)] = set->row;
    mesh::fill_halo(mesh_, MPIU_INT, 1, rows.data());
    for (Index v = mesh_.owned_vertices(); v < mesh_.vertices(); ++v)
      if (EnrichedSet* set = find(v, crack)) set->row = rows[static_cast<std::size_t>(v)];
  }
  for (CutElement& cut : cells_)
    for (std::size_t a = 0; a < 4; ++a)
      if (cut.element.enriched[a])
        cut.sets[a] = find(mesh_.cell(cut.cell)[a], cut.piece ? cut.piece->set[a] : cut.crack)->row;
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

std::span<const CutElement> EnrichedSets::all_of(Index cell) const { return run_of(cells_, cell, &CutElement::cell); }

std::pair<const CutElement*, Side> EnrichedSets::at(Index cell, const Vector<2>& x) const
{
  const std::span<const CutElement> all = all_of(cell);
  if (!all.front().piece) return {&all.front(), side_in(all.front(), x)};
  const CutElement* best = &all.front();
  double nearest = std::numeric_limits<double>::infinity();
  for (const CutElement& cut : all) {
    if (cut.piece->side && *cut.piece->side == side_of(cracks_->side(cut.crack, x))) return {&cut, Side::plus};
    for (const geom::Polygon& outline : cut.piece->outlines)
      if (const double out = how_far_out(outline, x); out < nearest) {
        nearest = out;
        best = &cut;
      }
  }
  return {best, Side::plus};
}

Side EnrichedSets::side_in(const CutElement& cut, const Vector<2>& x) const
{
  if (cut.snapped) return *cut.snapped;
  return cracks_->side(cut.crack, x) > 0 ? Side::plus : Side::minus;
}
} // namespace pdx::xfem
