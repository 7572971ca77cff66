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
  Index natural;      // cell
  int crack, snapped; // snapped: 0 no, -1 minus, 1 plus
  std::array<double, 4> distance;
};

std::array<Index, 4> natural_nodes(const mesh::Mesh& mesh, Index cell)
{
  std::array<Index, 4> nodes;
  for (std::size_t a = 0; a < 4; ++a) nodes[a] = mesh.natural_vertex(mesh.cell(cell)[a]);
  return nodes;
}

void sort_unique(std::vector<Index>& numbers)
{
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}
} // namespace

JunctionZone::JunctionZone(const mesh::Mesh& mesh, const crack::CrackSet& cracks, const MeshView& view,
                           std::span<const NearCell> near, std::span<const CellCut> cuts, double tolerance,
                           const geom::Frame& frame)
    : mesh_(mesh), cracks_(cracks), tolerance_(tolerance),
      place_of_cell_(static_cast<std::size_t>(mesh.cells()), Index{-1}), codes_(cracks.size())
{
  if (cracks.empty()) return;
  find_nodes(view, near, cuts);
  refuse_patches(frame);
}

void JunctionZone::find_nodes(const MeshView& view, std::span<const NearCell> near, std::span<const CellCut> cuts)
{
  std::vector<Index> sure;
  std::vector<std::array<Index, 4>> free; // nodes of cells, and single ones, that may do without
  for (const Meeting& meeting : find_meetings(view, near, cuts, cracks_, tolerance_)) {
    const std::array<Index, 4> nodes = natural_nodes(mesh_, meeting.cell);
    if (meeting.several)
      sure.insert(sure.end(), nodes.begin(), nodes.end());
    else
      free.push_back(nodes);
  }
  for (const Index node : nodes_passed_twice(view, cuts))
    if (node < mesh_.owned_vertices()) {
      free.emplace_back();
      free.back().fill(mesh_.natural_vertex(node));
    }
  nodes_ = gather_all(mesh_.comm(), sure);
  free = gather_all(mesh_.comm(), free);
  if (!free.empty()) {
    std::vector<Index> asked, touched; // nodes of free cells, of patches too
    for (const std::array<Index, 4>& nodes : free) asked.insert(asked.end(), nodes.begin(), nodes.end());
    sort_unique(asked);
    for (Index c = 0; c < mesh_.owned_cells(); ++c)
      if (!is_element(mesh_, c))
        for (const Index node : natural_nodes(mesh_, c))
          if (std::ranges::binary_search(asked, node)) touched.push_back(node);
    touched = gather_all(mesh_.comm(), touched);
    sort_unique(touched);
    for (const std::array<Index, 4>& nodes : free)
      if (std::ranges::none_of(nodes, [&](Index node) { return std::ranges::binary_search(touched, node); }))
        nodes_.insert(nodes_.end(), nodes.begin(), nodes.end());
  }
  sort_unique(nodes_);
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
    ZoneCell cell{mesh_.natural_cell(c), natural_nodes(mesh_, c), {}};
    for (std::size_t a = 0; a < 4; ++a) {
      cell.places[2 * a] = mesh_.point(vertices[a]).x();
      cell.places[2 * a + 1] = mesh_.point(vertices[a]).y();
    }
    cells.push_back(cell);
    for (const CellCut& cut : run_of(cuts, c, &CellCut::cell)) {
      const std::optional<Side>& side = snapped[static_cast<std::size_t>(&cut - cuts.data())];
      of_cells.push_back({cell.natural, cut.crack, side ? static_cast<int>(step(*side)) : 0, cut.distance});
    }
  }
  cells = gather_all(mesh_.comm(), cells);
  of_cells = gather_all(mesh_.comm(), of_cells);
  std::ranges::sort(cells, {}, &ZoneCell::natural);
  std::ranges::sort(of_cells, {}, [](const ZoneCut& cut) { return std::pair(cut.natural, cut.crack); });

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
  for (const ZoneCut& cut : of_cells)
    all.push_back({cell_of.at(cut.natural), cut.crack, cut.distance,
                   cut.snapped ? std::optional(side_of(cut.snapped)) : std::nullopt});
  std::vector<Index> copied;
  for (const Index node : nodes_) copied.push_back(node_of.at(node));
  const std::vector<CopiedNode> before = std::move(pieces_.nodes); // empty the first time, else the same nodes
  pieces_ = cut_in_pieces({corners, points, active}, all, copied, cracks_, least_share, tolerance_);
  for (CopiedNode& node : pieces_.nodes) {
    node.node = natural[static_cast<std::size_t>(node.node)];
    for (const NodeCopy& copy : node.copies) codes_ = std::max(codes_, copy.code + 1);
  }
  std::ranges::sort(pieces_.nodes, {}, &CopiedNode::node);
  for (std::size_t k = 0; k < before.size(); ++k) // what a cell was snapped for is not lost again
    pieces_.nodes[k].lost = std::max(pieces_.nodes[k].lost, before[k].lost);
  std::map<Index, Index> place_of; // by natural cell
  for (std::size_t k = 0; k < pieces_.cells.size(); ++k)
    place_of[cells[static_cast<std::size_t>(pieces_.cells[k].cell)].natural] = static_cast<Index>(k);
  for (Index c = 0; c < mesh_.cells(); ++c) {
    const auto at = place_of.find(mesh_.natural_cell(c));
    place_of_cell_[static_cast<std::size_t>(c)] = at != place_of.end() ? at->second : -1;
  }
}

bool JunctionZone::snap(const MeshView& view, std::span<const CellCut> cuts, Snaps& snapped) const
{
  bool any = false;
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const Index cell = cuts[i].cell;
    if (snapped[i] || !has_cell(cell) || !pieced(cell).left()) continue;
    const auto& nodes = view.cells[static_cast<std::size_t>(cell)];
    if (std::ranges::all_of(nodes, [this](Index node) { return has_node(node); })) continue;
    snapped[i] = pieced(cell).left();
    any = true;
  }
  return any;
}

const PiecedCell& JunctionZone::pieced(Index cell) const
{
  return pieces_.cells[static_cast<std::size_t>(place_of_cell_[static_cast<std::size_t>(cell)])];
}

const CopiedNode& JunctionZone::copies(Index vertex) const
{
  const Index natural = mesh_.natural_vertex(vertex);
  return *std::ranges::lower_bound(pieces_.nodes, natural, {}, &CopiedNode::node);
}
} // namespace pdx::xfem
