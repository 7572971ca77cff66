#include "pdx/xfem/pieces.hpp"

#include "parted_cells.hpp"
#include "pdx/base/joined.hpp"
#include "pdx/base/run_of.hpp"
#include "pdx/mesh/locate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace pdx::xfem {
namespace {
constexpr double kClearOf = 0.01; // of the way to a body's middle: more than places are rounded by

int next_edge(int edge) { return (edge + 1) % 4; }

Vector<2> middle_of(const geom::Polygon& outline)
{
  Vector<2> sum = Vector<2>::Zero();
  for (const Vector<2>& x : outline) sum += x;
  return sum / static_cast<double>(outline.size());
}

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
  Copies(const MeshView& view, std::span<const PieceCut> cuts, double least_share, int cracks)
      : view_(view), least_share_(least_share), cracks_(cracks)
  {
    for (const Index c : view.active) {
      const std::span<const PieceCut> of_cell = run_of(cuts, c, &PieceCut::cell);
      cells_.emplace_back(c, view.corners(c), of_cell);
      if (of_cell.size() < 2) continue;
      for (const Index node : nodes_of(c)) around_[node];
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
    for (bool quiet = false; !quiet;) {
      quiet = true;
      for (const auto& [node, support] : around_) {
        const int given_up = give_up_slivers(bodies_of(node, support));
        lost[node] += given_up;
        quiet = quiet && given_up == 0;
      }
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
        const Side side = codes[b] < cracks_ ? side_of_node(support, codes[b]) : Side::minus;
        copied.copies.push_back({codes[b], side, place_in(bodies[b], node)});
      }
      std::ranges::sort(copied.copies, {}, &NodeCopy::code);
      all.nodes.push_back(std::move(copied));
    }
    for (std::size_t k = 0; k < cells_.size(); ++k)
      if (!cells_[k].cuts().empty()) all.cells.push_back(pieces_of(cells_[k], sets[k]));
    return all;
  }

private:
  using Support = std::vector<SupportCell>;
  const std::array<Index, 4>& nodes_of(Index cell) const { return view_.cells[static_cast<std::size_t>(cell)]; }
  const Vector<2>& point(Index node) const { return view_.points[static_cast<std::size_t>(node)]; }

  /// The bodies of a node's support, those that hold the node first, then in order of cells and parts.
  std::vector<Body> bodies_of(Index node, const Support& support) const
  {
    std::vector<std::pair<std::size_t, int>> parts;
    std::map<std::pair<std::size_t, int>, std::size_t> number;
    for (const SupportCell& at : support)
      for (std::size_t p = 0; p < cells_[at.cell].parts().size(); ++p) {
        if (!cells_[at.cell].parts()[p].is_own()) continue;
        number[{at.cell, static_cast<int>(p)}] = parts.size();
        parts.emplace_back(at.cell, static_cast<int>(p));
      }
    Joined joined(parts.size());
    for (std::size_t i = 0; i < support.size(); ++i)
      for (std::size_t j = i + 1; j < support.size(); ++j)
        join_along_edges(support[i].cell, support[j].cell, number, joined);
    std::vector<Body> bodies;
    std::map<std::size_t, std::size_t> body_of; // by root
    for (std::size_t k = 0; k < parts.size(); ++k) {
      const auto [at, fresh] = body_of.try_emplace(joined.root(k), bodies.size());
      if (fresh) bodies.emplace_back();
      bodies[at->second].parts.push_back(parts[k]);
      bodies[at->second].area += area_of(parts[k]);
    }
    for (const SupportCell& at : support)
      for (const bool behind : {false, true}) { // the two edges at the node
        const int edge = behind ? (at.corner + 3) % 4 : at.corner;
        const int part = at_corner(cells_[at.cell], edge, behind);
        if (part >= 0) bodies[body_of.at(joined.root(number.at({at.cell, part})))].home = true;
      }
    choose_home(bodies);
    for (Body& body : bodies) note_cracks(body, node, support);
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

  double area_of(const std::pair<std::size_t, int>& part) const
  {
    const PartedCell& cell = cells_[part.first];
    double sum = 0.0;
    for (std::size_t p = 0; p < cell.parts().size(); ++p)
      if (cell.mover_of(static_cast<int>(p)) == part.second) sum += geom::area(cell.parts()[p].outline);
    return sum;
  }

  /// The part of a cell at the very begin or end of an edge.
  static int at_corner(const PartedCell& cell, int edge, bool end)
  {
    const std::vector<double>& at = cell.crossings(edge);
    if (at.empty()) return cell.part_at(edge, 0.5);
    return cell.part_at(edge, end ? 0.5 * (at.back() + 1.0) : 0.5 * at.front());
  }

  void join_along_edges(std::size_t one, std::size_t two,
                        const std::map<std::pair<std::size_t, int>, std::size_t>& number, Joined& joined) const
  {
    const PartedCell &a = cells_[one], &b = cells_[two];
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const auto &of_a = nodes_of(a.cell()), &of_b = nodes_of(b.cell());
        const auto at = [](int k) { return static_cast<std::size_t>(k); };
        if (of_a[at(i)] != of_b[at(next_edge(j))] || of_a[at(next_edge(i))] != of_b[at(j)]) continue;
        std::vector<double> cuts{0.0, 1.0};
        cuts.insert(cuts.end(), a.crossings(i).begin(), a.crossings(i).end());
        for (const double t : b.crossings(j)) cuts.push_back(1.0 - t);
        std::ranges::sort(cuts);
        for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
          if (cuts[k + 1] - cuts[k] < kSamePlace) continue; // one crossing, seen from both cells
          const double middle = 0.5 * (cuts[k] + cuts[k + 1]);
          const int p = a.part_at(i, middle), q = b.part_at(j, 1.0 - middle);
          if (p >= 0 && q >= 0) joined.join(number.at({one, p}), number.at({two, q}));
        }
      }
  }
  static constexpr double kSamePlace = 1e-10; // of an edge: one crossing, as either cell rounds it

  Side side_of_node(const Support& support, int crack) const
  {
    for (const SupportCell& at : support)
      for (const PieceCut& cut : cells_[at.cell].cuts())
        if (cut.crack == crack) return side_of(cut.distance[static_cast<std::size_t>(at.corner)]);
    return Side::minus;
  }

  /// Cracks between a body and its node.
  void note_cracks(Body& body, Index, const Support& support) const
  {
    if (body.home) return;
    std::set<int> across;
    for (const auto& [cell, part] : body.parts)
      for (const auto& [crack, side] : cells_[cell].parts()[static_cast<std::size_t>(part)].sides)
        if (side != side_of_node(support, crack)) across.insert(crack);
    body.across.assign(across.begin(), across.end());
  }

  /// Codes of bodies, -1 for the one of the node itself.
  std::vector<int> name(const std::vector<Body>& bodies) const
  {
    std::vector<int> codes;
    int further = cracks_;
    for (const Body& body : bodies) {
      const bool alone = body.across.size() == 1 && std::ranges::count(bodies, body.across, &Body::across) == 1;
      codes.push_back(body.home ? -1 : alone ? body.across[0] : further++);
    }
    return codes;
  }

  /// What has too little of a support goes with its neighbour in the cell. How many bodies did so.
  int give_up_slivers(const std::vector<Body>& bodies)
  {
    double total = 0.0;
    for (const Body& body : bodies) total += body.area;
    int given_up = 0;
    for (const Body& body : bodies) {
      if (!(body.area < least_share_ * total)) continue;
      bool any = false;
      for (const auto& [cell, part] : body.parts) {
        const int neighbour = cells_[cell].neighbour_of(part);
        if (neighbour < 0) continue;
        cells_[cell].parts()[static_cast<std::size_t>(part)].taken_by = neighbour;
        any = true;
      }
      given_up += any;
    }
    return given_up;
  }

  /// Corners of nodes that are no node of a cell with several cracks: across the one crack of their cell.
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

  Vector<2> place_in(const Body& body, Index node) const
  {
    const Vector<2>& x = point(node);
    const geom::Polygon* nearest = nullptr;
    Vector<2> best = x;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [cell, part] : body.parts) {
      const geom::Polygon& outline = cells_[cell].parts()[static_cast<std::size_t>(part)].outline;
      const Vector<2> at = nearest_in(outline, x);
      if ((at - x).norm() >= least) continue;
      least = (at - x).norm();
      best = at;
      nearest = &outline;
    }
    const Vector<2> middle = middle_of(*nearest);
    const double clear = kClearOf * (middle - best).norm();
    const Vector<2> further = best + clear / std::max(least, 1e-6 * clear) * (best - x);
    return is_in(*nearest, further, 1e-6 * clear) ? further : best + kClearOf * (middle - best);
  }

  static PiecedCell pieces_of(const PartedCell& cell, const std::vector<std::array<int, 4>>& sets)
  {
    PiecedCell all{cell.cell(), {}};
    std::map<int, std::size_t> number; // by part
    for (std::size_t p = 0; p < cell.parts().size(); ++p) {
      if (!cell.parts()[p].is_own()) continue;
      number[static_cast<int>(p)] = all.pieces.size();
      Piece piece;
      piece.outlines.push_back(cell.parts()[p].outline);
      piece.set = sets[p];
      if (cell.cuts().size() == 1) piece.side = cell.parts()[p].side_of_crack(cell.cuts()[0].crack);
      all.pieces.push_back(std::move(piece));
    }
    for (std::size_t p = 0; p < cell.parts().size(); ++p)
      if (!cell.parts()[p].is_own())
        all.pieces[number.at(cell.mover_of(static_cast<int>(p)))].outlines.push_back(cell.parts()[p].outline);
    for (int edge = 0; edge < 4; ++edge) {
      std::vector<double> at{0.0};
      at.insert(at.end(), cell.crossings(edge).begin(), cell.crossings(edge).end());
      at.push_back(1.0);
      for (std::size_t k = 0; k + 1 < at.size(); ++k)
        if (at[k + 1] > at[k]) {
          const int mover = cell.mover_of(cell.owner_at(edge, 0.5 * (at[k] + at[k + 1])));
          all.pieces[number.at(mover)].edges.push_back({edge, at[k], at[k + 1]});
        }
    }
    return all;
  }

  const MeshView& view_;
  double least_share_;
  int cracks_;
  std::vector<PartedCell> cells_;
  std::map<Index, Support> around_; // nodes of cells with several cracks
};
} // namespace

Pieces cut_in_pieces(const MeshView& view, std::span<const PieceCut> cuts, double least_share, int cracks)
{
  return Copies(view, cuts, least_share, cracks).make();
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
