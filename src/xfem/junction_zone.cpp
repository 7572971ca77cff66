#include "junction_zone.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/base/run_of.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <map>

namespace pdx::xfem {
namespace {
/// A cell of the zone, as all ranks know it.
struct ZoneCell {
  Index natural;
  std::array<Index, 4> nodes;   // natural
  std::array<double, 8> places; // of the corners [m]
};
struct ZoneCut {
  Index natural;                    // cell
  int crack, entry, other, snapped; // snapped: 0 no, -1 minus, 1 plus
  std::array<double, 4> distance;
  std::array<double, 2> end;
};

bool is_element(const mesh::Mesh& mesh, Index cell)
{
  return mesh.use(cell) != mesh::Use::covered && mesh.use(cell) != mesh::Use::points;
}

/// Adds the vertices of an owned cell.
void add_nodes(const mesh::Mesh& mesh, Index cell, std::vector<Index>& nodes)
{
  if (cell < mesh.owned_cells())
    for (const Index v : mesh.cell(cell)) nodes.push_back(mesh.natural_vertex(v));
}

template <class Records> auto of_cell(const Records& records, Index cell)
{
  return run_of(records, cell, [](const auto& record) { return record.cell; });
}
} // namespace

double depth_in(const mesh::Mesh& mesh, Index cell, const Vector<2>& x)
{
  const auto corners = mesh.corners(cell);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector<2> along = (corners[(k + 1) % 4] - corners[k]).normalized(), to = x - corners[k];
    least = std::min(least, along.x() * to.y() - along.y() * to.x());
  }
  return least;
}

JunctionZone::JunctionZone(const mesh::Mesh& mesh, const crack::CrackSet& cracks, std::span<const CellCut> cuts,
                           std::span<const EndCut> ends, double tolerance, const geom::Frame& frame)
    : mesh_(mesh), cracks_(cracks), place_of_cell_(static_cast<std::size_t>(mesh.cells()), Index{-1}),
      codes_(cracks.size())
{
  refuse_ends(cuts, ends, tolerance, frame);
  find_nodes(cuts);
  refuse_patches(frame);
}

/// Keeps those that meet in their cell what they end on; the rest is only rounding if another cell has both.
void JunctionZone::refuse_ends(std::span<const CellCut> cuts, std::span<const EndCut> ends, double tolerance,
                               const geom::Frame& frame)
{
  const auto has = [&](Index cell, int crack) {
    const auto through = of_cell(cuts, cell);
    return std::ranges::any_of(through, [crack](const CellCut& cut) { return cut.crack == crack; }) ||
           std::ranges::any_of(ends, [&](const EndCut& end) {
             return end.cut.cell == cell && end.cut.crack == crack && end.cut.entry >= 0;
           });
  };
  std::vector<std::size_t> open, met; // numbers of junctions
  for (const EndCut& end : ends) {
    const bool meets = end.cut.entry >= 0 && has(end.cut.cell, end.cut.other);
    if (meets) ends_.push_back(end.cut);
    if (end.cut.cell < mesh_.owned_cells()) (meets ? met : open).push_back(end.junction);
  }
  std::ranges::stable_sort(ends_, {}, &PieceCut::cell);
  for (std::size_t k = 0; k < cracks_.junctions().size(); ++k) {
    const crack::Junction& junction = cracks_.junctions()[k];
    for (const CellCut& cut : cuts)
      if (cut.crack == junction.crack && cut.cell < mesh_.owned_cells() && has(cut.cell, junction.other) &&
          depth_in(mesh_, cut.cell, junction.at) >= -4.0 * tolerance)
        met.push_back(k);
  }
  open = gather_all(mesh_.comm(), open);
  met = gather_all(mesh_.comm(), met);
  std::erase_if(open, [&](std::size_t k) { return std::ranges::find(met, k) != met.end(); });
  if (open.empty()) return;
  const crack::Junction& first = cracks_.junctions()[*std::ranges::min_element(open)];
  throw UserError(fmt::format("crack {} ends on crack {} inside an element, {}, and the two do not part it: give one "
                              "line through both, refine the mesh, or put a patch there",
                              first.crack + 1, first.other + 1, frame.text(first.at)));
}

void JunctionZone::find_nodes(std::span<const CellCut> cuts)
{
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const bool more = (i > 0 && cuts[i - 1].cell == cuts[i].cell) || !of_cell(ends_, cuts[i].cell).empty();
    if (more) add_nodes(mesh_, cuts[i].cell, nodes_);
  }
  for (const PieceCut& end : ends_) add_nodes(mesh_, end.cell, nodes_);
  nodes_ = gather_all(mesh_.comm(), nodes_);
  std::ranges::sort(nodes_);
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
}

void JunctionZone::refuse_patches(const geom::Frame& frame) const
{
  if (nodes_.empty()) return;
  Index first = mesh_.global_vertices();
  for (Index c = 0; c < mesh_.owned_cells(); ++c)
    for (const Index v : mesh_.cell(c))
      if (!is_element(mesh_, c) && has_node(v)) first = std::min(first, mesh_.natural_vertex(v));
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, mesh_.comm());
  if (first == mesh_.global_vertices()) return;
  Vector<2> at = Vector<2>::Constant(std::numeric_limits<double>::lowest());
  for (Index v = 0; v < mesh_.vertices(); ++v)
    if (mesh_.natural_vertex(v) == first) at = mesh_.point(v);
  MPI_Allreduce(MPI_IN_PLACE, at.data(), 2, MPI_DOUBLE, MPI_MAX, mesh_.comm());
  throw UserError(fmt::format("an element that several cracks cut touches a patch at {}: leave one row of elements "
                              "between them, or put the patch over it",
                              frame.text(at)));
}

bool JunctionZone::has_node(Index vertex) const
{
  return std::ranges::binary_search(nodes_, mesh_.natural_vertex(vertex));
}

void JunctionZone::part(std::span<const CellCut> cuts, const Snaps& snapped, double least_share)
{
  std::vector<ZoneCell> cells;
  std::vector<ZoneCut> of_cells;
  for (Index c = 0; c < mesh_.owned_cells(); ++c) {
    const auto& vertices = mesh_.cell(c);
    if (!is_element(mesh_, c) || std::ranges::none_of(vertices, [&](Index v) { return has_node(v); })) continue;
    ZoneCell cell{mesh_.natural_cell(c), {}, {}};
    for (std::size_t a = 0; a < 4; ++a) {
      cell.nodes[a] = mesh_.natural_vertex(vertices[a]);
      cell.places[2 * a] = mesh_.point(vertices[a]).x();
      cell.places[2 * a + 1] = mesh_.point(vertices[a]).y();
    }
    cells.push_back(cell);
    for (const CellCut& cut : of_cell(cuts, c)) {
      const std::optional<Side>& side = snapped[static_cast<std::size_t>(&cut - cuts.data())];
      of_cells.push_back({cell.natural, cut.crack, -1, -1, side ? static_cast<int>(step(*side)) : 0, cut.distance, {}});
    }
    for (const PieceCut& end : of_cell(ends_, c))
      of_cells.push_back({cell.natural, end.crack, end.entry, end.other, 0, end.distance, {end.end.x(), end.end.y()}});
  }
  cells = gather_all(mesh_.comm(), cells);
  of_cells = gather_all(mesh_.comm(), of_cells);
  std::ranges::sort(cells, {}, &ZoneCell::natural);
  std::ranges::sort(of_cells, {},
                    [](const ZoneCut& cut) { return std::tuple(cut.natural, cut.entry >= 0, cut.crack); });

  std::map<Index, Index> node_of; // by natural number
  for (const ZoneCell& cell : cells)
    for (const Index node : cell.nodes) node_of[node];
  std::vector<Index> natural; // of each node
  for (auto& [node, place] : node_of) {
    place = static_cast<Index>(natural.size());
    natural.push_back(node);
  }
  std::vector<std::array<Index, 4>> corners;
  std::vector<Vector<2>> points(natural.size());
  std::vector<Index> active;
  std::map<Index, Index> cell_of;
  for (const ZoneCell& cell : cells) {
    std::array<Index, 4> at;
    for (std::size_t a = 0; a < 4; ++a) {
      at[a] = node_of.at(cell.nodes[a]);
      points[static_cast<std::size_t>(at[a])] = {cell.places[2 * a], cell.places[2 * a + 1]};
    }
    cell_of[cell.natural] = static_cast<Index>(active.size());
    active.push_back(static_cast<Index>(active.size()));
    corners.push_back(at);
  }
  std::vector<PieceCut> all;
  for (const ZoneCut& cut : of_cells) {
    const std::optional<Side> side = cut.snapped ? std::optional(side_of(cut.snapped)) : std::nullopt;
    all.push_back(
        {cell_of.at(cut.natural), cut.crack, cut.distance, side, cut.entry, cut.other, {cut.end[0], cut.end[1]}});
  }
  pieces_ = cut_in_pieces({corners, points, active}, all, least_share, cracks_.size());
  for (CopiedNode& node : pieces_.nodes) {
    node.node = natural[static_cast<std::size_t>(node.node)];
    for (const NodeCopy& copy : node.copies) codes_ = std::max(codes_, copy.code + 1);
  }
  std::ranges::sort(pieces_.nodes, {}, &CopiedNode::node);
  std::map<Index, Index> place_of; // by natural cell
  for (std::size_t k = 0; k < pieces_.cells.size(); ++k)
    place_of[cells[static_cast<std::size_t>(pieces_.cells[k].cell)].natural] = static_cast<Index>(k);
  for (Index c = 0; c < mesh_.cells(); ++c)
    if (const auto at = place_of.find(mesh_.natural_cell(c)); at != place_of.end())
      place_of_cell_[static_cast<std::size_t>(c)] = at->second;
}

const std::vector<Piece>& JunctionZone::pieces(Index cell) const
{
  return pieces_.cells[static_cast<std::size_t>(place_of_cell_[static_cast<std::size_t>(cell)])].pieces;
}

const CopiedNode& JunctionZone::copies(Index vertex) const
{
  const Index natural = mesh_.natural_vertex(vertex);
  return *std::ranges::lower_bound(pieces_.nodes, natural, {}, &CopiedNode::node);
}
} // namespace pdx::xfem
