#include "pdx/xfem/pieces.hpp"

#include "parted_cells.hpp"
#include "pdx/base/joined.hpp"
#include "pdx/base/run_of.hpp"
#include "plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace pdx::xfem {
namespace {
constexpr double kClearOf = 0.01; // of the way to a body's middle: more than places are rounded by
constexpr double kSmall = 1e-3;   // of the largest outline of a body: no place for it

/// The place of a convex outline that is nearest to x.
Vector<2> nearest_in(const geom::Polygon& outline, const Vector<2>& x)
{
  Vector<2> best = outline.front();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector<2>&a = outline[k], &b = outline[(k + 1) % outline.size()];
    const Vector<2> along = b - a;
    const double t = std::clamp((x - a).dot(along) / std::max(along.squaredNorm(), 1e-300), 0.0, 1.0);
    const Vector<2> at = a + t * along;
    if ((at - x).norm() >= least) continue;
    least = (at - x).norm();
    best = at;
  }
  return best;
}

bool is_in(const geom::Polygon& outline, const Vector<2>& x, double margin)
{
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Vector<2> along = outline[(k + 1) % outline.size()] - outline[k], to = x - outline[k];
    if (along.x() * to.y() - along.y() * to.x() < -margin * along.norm()) return false;
  }
  return true;
}

/// A cell of a node's support and which of its corners the node is.
struct SupportCell {
  std::size_t cell; // among all
  int corner;
};

/// A body of a node's support.
struct Body {
  std::vector<std::pair<std::size_t, int>> parts; // cell, part
  double area = 0.0;                              // [m^2]
  bool home = false;                              // holds the node
  std::vector<int> across;                        // cracks between it and the node
};

class Copies {
public:
  Copies(const MeshView& view, std::span<const PieceCut> cuts, std::span<const Index> nodes,
         const crack::CrackSet& cracks, double least_share, double tolerance)
      : view_(view), cracks_(cracks), net_(view, cracks, tolerance), least_share_(least_share), tolerance_(tolerance)
  {
    for (const Index node : nodes) around_[node];
    for (const Index c : view.active) {
      const bool within = std::ranges::all_of(nodes_of(c), [&](Index node) { return around_.contains(node); });
      cells_.emplace_back(net_, cells_.size(), c, view.corners(c), run_of(cuts, c, &PieceCut::cell), cracks, !within);
    }
    for (std::size_t k = 0; k < cells_.size(); ++k)
      for (int corner = 0; corner < 4; ++corner)
        if (const auto at = around_.find(nodes_of(cells_[k].cell())[static_cast<std::size_t>(corner)]);
            at != around_.end())
          at->second.push_back({k, corner});
  }

  Pieces make()
  {
    std::map<Index, int> lost;
    while (give_up_slivers(lost)) {
    }
    Pieces all;
    std::map<std::size_t, std::vector<std::array<int, 4>>> sets; // of each part of a cell
    for (std::size_t k = 0; k < cells_.size(); ++k) sets[k] = sets_of_sides(cells_[k]);
    for (const auto& [node, support] : around_) {
      std::vector<Body> bodies = bodies_of(node, support);
      const std::vector<int> codes = name(bodies);
      CopiedNode copied{node, {}, lost[node]};
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        for (const auto& [cell, part] : bodies[b].parts)
          for (const SupportCell& at : support)
            if (at.cell == cell)
              sets[cell][static_cast<std::size_t>(part)][static_cast<std::size_t>(at.corner)] = codes[b];
        if (codes[b] < 0) continue;
        const Side side = codes[b] < cracks_.size() ? side_of_node(node, codes[b]) : Side::minus;
        copied.copies.push_back({codes[b], side, place_in(bodies[b], node)});
      }
      std::ranges::sort(copied.copies, {}, &NodeCopy::code);
      all.nodes.push_back(std::move(copied));
    }
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const bool is_plain = std::ranges::all_of(
          sets[k], [](const auto& set) { return std::ranges::all_of(set, [](int code) { return code < 0; }); });
      if (!is_plain || !cells_[k].cuts().empty() || cells_[k].parts().size() > 1)
        all.cells.push_back(pieces_of(cells_[k], sets[k]));
    }
    return all;
  }

private:
  using Support = std::vector<SupportCell>;
  using PlacedPart = std::pair<std::size_t, int>; // cell, part
  const std::array<Index, 4>& nodes_of(Index cell) const { return view_.cells[static_cast<std::size_t>(cell)]; }
  const Vector<2>& point(Index node) const { return view_.points[static_cast<std::size_t>(node)]; }

  /// The bodies of a node's support, that which holds the node first, then in order of cells and parts.
  std::vector<Body> bodies_of(Index node, const Support& support) const
  {
    std::vector<PlacedPart> parts;
    std::map<PlacedPart, std::size_t> number;
    for (const SupportCell& at : support)
      for (std::size_t p = 0; p < cells_[at.cell].parts().size(); ++p) {
        if (cells_[at.cell].parts()[p].taken_by >= 0) continue;
        number[{at.cell, static_cast<int>(p)}] = parts.size();
        parts.emplace_back(at.cell, static_cast<int>(p));
      }
    const std::vector<bool> is_at = parts_at(node, support, number);
    Joined joined(parts.size());
    join_along_edges(support, number, joined);
    std::vector<Body> bodies;
    std::map<std::size_t, std::size_t> body_of; // by root
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto [at, fresh] = body_of.try_emplace(joined.root(k), bodies.size());
      if (fresh) bodies.emplace_back();
      bodies[at->second].parts.push_back(parts[k]);
      bodies[at->second].area += area_of(parts[k]);
      bodies[at->second].home = bodies[at->second].home || is_at[k];
    }
    choose_home(bodies);
    for (Body& body : bodies) note_cracks(body, node);
    return bodies;
  }

  /// The node's own displacement is that of the largest body that holds it, or else of the largest one.
  static void choose_home(std::vector<Body>& bodies)
  {
    const bool any = std::ranges::any_of(bodies, &Body::home);
    Body* home = nullptr;
    for (Body& body : bodies)
      if ((body.home || !any) && (!home || body.area > home->area)) home = &body;
    for (Body& body : bodies) body.home = &body == home;
    std::ranges::stable_sort(bodies, [](const Body& a, const Body& b) { return a.home && !b.home; });
  }

  double area_of(const PlacedPart& part) const
  {
    const PartedCell& cell = cells_[part.first];
    double sum = 0.0;
    for (std::size_t p = 0; p < cell.parts().size(); ++p)
      if (cell.mover_of(static_cast<int>(p)) == part.second) sum += cell.parts()[p].area;
    return sum;
  }

  /// Which parts touch the node along an edge.
  std::vector<bool> parts_at(Index node, const Support& support, const std::map<PlacedPart, std::size_t>& number) const
  {
    std::vector<bool> is_at(number.size(), false);
    for (const SupportCell& at : support)
      for (const PartedCell::Share& share : cells_[at.cell].border())
        if (const auto part = number.find({at.cell, share.part});
            part != number.end() && share.held && (share.from == node || share.to == node))
          is_at[part->second] = true;
    return is_at;
  }

  void join_along_edges(const Support& support, const std::map<PlacedPart, std::size_t>& number, Joined& joined) const
  {
    std::map<std::pair<int, int>, std::size_t> held; // by vertices
    for (const SupportCell& at : support)
      for (const PartedCell::Share& share : cells_[at.cell].border()) {
        const auto part = number.find({at.cell, share.part});
        if (part == number.end() || share.open || !share.held) continue;
        held[{share.from, share.to}] = part->second;
        if (const auto other = held.find({share.to, share.from}); other != held.end())
          joined.join(part->second, other->second);
      }
  }

  /// As `crack::find_cuts` sees nodes.
  Side side_of_node(Index node, int crack) const
  {
    const double distance = cracks_.signed_distance(crack, point(node));
    return std::abs(distance) <= tolerance_ ? Side::plus : side_of(distance);
  }

  /// Cracks between a body and its node.
  void note_cracks(Body& body, Index node) const
  {
    if (body.home) return;
    std::set<int> across;
    for (const auto& [cell, part] : body.parts)
      for (const auto& [crack, side] : cells_[cell].parts()[static_cast<std::size_t>(part)].sides)
        if (side != side_of_node(node, crack)) across.insert(crack);
    body.across.assign(across.begin(), across.end());
  }

  /// Codes of bodies, -1 for the one of the node itself.
  std::vector<int> name(const std::vector<Body>& bodies) const
  {
    std::vector<int> codes;
    int further = cracks_.size();
    for (const Body& body : bodies) {
      const bool alone = body.across.size() == 1 && std::ranges::count(bodies, body.across, &Body::across) == 1;
      codes.push_back(body.home ? -1 : alone ? body.across[0] : further++);
    }
    return codes;
  }

  /// What has too little of a support goes with its neighbour in the cell. All nodes are judged before anything moves,
  /// so that their order does not matter. False: nothing has too little.
  bool give_up_slivers(std::map<Index, int>& lost)
  {
    std::map<std::size_t, std::set<int>> wanted;        // parts of cells
    std::vector<std::pair<Index, PlacedPart>> of_nodes; // first parts of bodies
    for (const auto& [node, support] : around_) {
      const std::vector<Body> bodies = bodies_of(node, support);
      double total = 0.0;
      for (const Body& body : bodies) total += body.area;
      for (const Body& body : bodies) {
        if (!(body.area < least_share_ * total)) continue;
        for (const auto& [cell, part] : body.parts) wanted[cell].insert(part);
        of_nodes.emplace_back(node, body.parts.front());
      }
    }
    bool any = false;
    for (const auto& [cell, parts] : wanted) {
      std::vector<int> left, going(parts.begin(), parts.end());
      for (std::size_t p = 0; p < cells_[cell].parts().size(); ++p)
        if (cells_[cell].parts()[p].taken_by < 0 && !parts.contains(static_cast<int>(p)))
          left.push_back(static_cast<int>(p));
      for (bool more = true; more;) { // those beside what stays first, then those beside them
        more = false;
        std::vector<std::pair<int, int>> taken;
        for (const int part : going)
          if (const int by = cells_[cell].neighbour_of(part, left); by >= 0) taken.emplace_back(part, by);
        for (const auto& [part, by] : taken) {
          cells_[cell].take(part, by);
          left.push_back(part);
          std::erase(going, part);
          any = more = true;
        }
      }
    }
    for (const auto& [node, first] : of_nodes)
      lost[node] += cells_[first.first].parts()[static_cast<std::size_t>(first.second)].taken_by >= 0;
    return any;
  }

  /// Corners of nodes without copies: across the one crack of their cell.
  static std::vector<std::array<int, 4>> sets_of_sides(const PartedCell& cell)
  {
    std::vector<std::array<int, 4>> sets(cell.parts().size(), {-1, -1, -1, -1});
    if (cell.cuts().size() != 1) return sets;
    const PieceCut& cut = cell.cuts()[0];
    for (std::size_t p = 0; p < sets.size(); ++p)
      for (std::size_t a = 0; a < 4; ++a)
        if (const auto side = cell.parts()[p].side_of_crack(cut.crack); side && *side != side_of(cut.distance[a]))
          sets[p][a] = cut.crack;
    return sets;
  }

  /// A place in a body, clear of its border, the nearest to the node but for what is small.
  Vector<2> place_in(const Body& body, Index node) const
  {
    const Vector<2>& x = point(node);
    double largest = 0.0;
    const auto visit_outlines = [&](const auto& visit) {
      for (const auto& [cell, part] : body.parts)
        for (const geom::Polygon& outline : cells_[cell].parts()[static_cast<std::size_t>(part)].outlines)
          visit(outline);
    };
    visit_outlines([&](const geom::Polygon& outline) { largest = std::max(largest, geom::area(outline)); });
    const geom::Polygon* nearest = nullptr;
    Vector<2> best = x;
    double least = std::numeric_limits<double>::infinity();
    visit_outlines([&](const geom::Polygon& outline) {
      const Vector<2> at = nearest_in(outline, x);
      if (geom::area(outline) < kSmall * largest || (at - x).norm() >= least) return;
      least = (at - x).norm();
      best = at;
      nearest = &outline;
    });
    const Vector<2> inward = middle_of(*nearest) - best;
    const double clear = kClearOf * inward.norm();
    if (least > kClearOf * clear) {
      const Vector<2> further = best + clear / least * (best - x);
      if (is_in(*nearest, further, -kClearOf * clear)) return further;
    }
    return best + kClearOf * inward;
  }

  static PiecedCell pieces_of(const PartedCell& cell, const std::vector<std::array<int, 4>>& sets)
  {
    PiecedCell all{cell.cell(), {}};
    std::map<int, std::size_t> number; // by part
    const bool one_crack = cell.cuts().size() == 1 && cell.parting().size() <= 1 && cell.parts().size() <= 2;
    for (std::size_t p = 0; p < cell.parts().size(); ++p) {
      const CellPart& part = cell.parts()[p];
      if (part.taken_by >= 0) continue;
      number[static_cast<int>(p)] = all.pieces.size();
      Piece piece;
      piece.outlines = part.outlines;
      piece.set = sets[p];
      if (one_crack) piece.side = part.side_of_crack(cell.cuts()[0].crack);
      all.pieces.push_back(std::move(piece));
    }
    const auto piece_of = [&](int part) -> Piece& { return all.pieces[number.at(cell.mover_of(part))]; };
    for (std::size_t p = 0; p < cell.parts().size(); ++p)
      if (const CellPart& part = cell.parts()[p]; part.taken_by >= 0) {
        std::vector<geom::Polygon>& outlines = piece_of(static_cast<int>(p)).outlines;
        outlines.insert(outlines.end(), part.outlines.begin(), part.outlines.end());
      }
    for (const PartedCell::Share& share : cell.border())
      if (share.end > share.begin) piece_of(share.part).edges.push_back({share.edge, share.begin, share.end});
    return all;
  }

  const MeshView& view_;
  const crack::CrackSet& cracks_;
  CrackNet net_;
  double least_share_, tolerance_;
  std::vector<PartedCell> cells_;
  std::map<Index, Support> around_; // nodes with copies
};
} // namespace

Pieces cut_in_pieces(const MeshView& view, std::span<const PieceCut> cuts, std::span<const Index> nodes,
                     const crack::CrackSet& cracks, double least_share, double tolerance)
{
  return Copies(view, cuts, nodes, cracks, least_share, tolerance).make();
}

EnrichedElement piece_element(const fem::Corners& corners, const Piece& piece, const std::array<double, 4>& factor)
{
  EnrichedElement element;
  element.of_piece = factor;
  for (std::size_t a = 0; a < 4; ++a) element.enriched[a] = factor[a] != 0.0;
  double area = 0.0;
  for (const geom::Polygon& outline : piece.outlines) area += geom::area(outline);
  if (piece.outlines.size() == 1 && piece.outlines[0].size() == 4 && area == geom::area(corners)) { // all of the cell
    element.cell = whole_cell(corners, Side::plus);
    return element;
  }
  for (const geom::Polygon& outline : piece.outlines) add_part_points(corners, outline, Side::plus, element.cell);
  return element;
}
} // namespace pdx::xfem
