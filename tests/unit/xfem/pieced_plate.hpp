#pragma once
#include "pdx/base/symmetric.hpp"
#include "pdx/crack/cut_cells.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/xfem/enriched_kernel.hpp"
#include "pdx/xfem/pieces.hpp"

#include <map>
#include <set>

namespace pdx::xfem {
/// Node of n x n cells of a square of side 1.
/// @param skew how far inner nodes are moved, in cells
inline Vector<2> node_of_plate(int n, int i, int j, double skew)
{
  const double wave = i % n == 0 || j % n == 0 ? 0.0 : skew;
  return {(i + wave * std::sin(3.0 * i + 5.0 * j)) / n, (j + wave * std::cos(4.0 * i - 7.0 * j)) / n};
}

/// n x n cells of a square of side 1, cut by cracks: elements, their rows and what moves with them.
class PiecedPlate {
public:
  PiecedPlate(int n, std::vector<crack::Polyline> lines, double least_share = 1e-4, double skew = 0.0)
      : cracks_(std::move(lines), geom::Box<2>{{0.0, 0.0}, {1.0, 1.0}})
  {
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.push_back(node_of_plate(n, i, j, skew));
    const auto node = [n](int i, int j) { return static_cast<Index>(i + (n + 1) * j); };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        active.push_back(static_cast<Index>(cells.size()));
        cells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
      }
    const double tolerance = 1e-9 / n;
    const std::vector<NearCell> near = find_cuts(tolerance);
    const MeshView view{cells, points, active};
    std::set<Index> zone; // nodes with copies
    for (const Meeting& meeting : find_meetings(view, near, cuts, cracks_, tolerance))
      zone.insert(cell(meeting.cell).begin(), cell(meeting.cell).end());
    const std::vector<Index> twice = nodes_passed_twice(view, cuts);
    zone.insert(twice.begin(), twice.end());
    std::vector<Index> around;
    for (const Index c : active)
      if (std::ranges::any_of(cell(c), [&](Index v) { return zone.contains(v); })) around.push_back(c);
    Snaps snapped;
    std::map<Index, int> lost_of;
    do { // as `EnrichedSets` does
      enrichment = enrich(view, cuts, {least_share, Quadrature::polygons}, snapped);
      snapped = enrichment.snapped;
      std::vector<PieceCut> all;
      for (std::size_t k = 0; k < cuts.size(); ++k)
        if (std::ranges::binary_search(around, cuts[k].cell))
          all.push_back({cuts[k].cell, cuts[k].crack, cuts[k].distance, snapped[k]});
      pieces = cut_in_pieces({cells, points, around}, all, std::vector<Index>(zone.begin(), zone.end()), cracks_,
                             least_share, tolerance);
      for (const CopiedNode& copied : pieces.nodes) lost_of[copied.node] = std::max(lost_of[copied.node], copied.lost);
    } while (snap_given_up(zone, snapped));
    std::map<Index, int> dropped_of; // by sides of cracks
    for (const NodeSupport& support : enrichment.dropped) dropped_of[support.node] += support.verdict == Verdict::share;
    for (const auto& [v, sides] : dropped_of) lost_of[v] = std::max(lost_of[v], sides);
    for (const auto& [v, bodies] : lost_of) lost += bodies;
    for (const CopiedNode& copied : pieces.nodes)
      for (const NodeCopy& copy : copied.copies) add(copied.node, copy.code, copy.side, copy.at);
    for (const NodeSupport& support : enrichment.nodes)
      if (!zone.contains(support.node)) add(support.node, support.crack, support.side, across(support));
  }

  struct Row {
    Side side;
    Vector<2> at; // in the body that it moves [m]
    int number;
  };
  int rows() const { return static_cast<int>(points.size() + sets.size()); }

  /// Calls visit(element, rows of its unknowns).
  template <class Visit> void for_each_element(Visit&& visit) const
  {
    const MeshView view{cells, points, active};
    for (const Index c : active) {
      const auto& nodes = cell(c);
      const std::vector<int> own(nodes.begin(), nodes.end());
      const auto of_cell = std::ranges::find(pieces.cells, c, &PiecedCell::cell);
      const auto cut = std::ranges::find(cuts, c, &CellCut::cell);
      if (of_cell == pieces.cells.end() && cut == cuts.end()) {
        EnrichedElement element;
        element.cell = whole_cell(view.corners(c), Side::plus);
        visit(element, own);
      } else if (of_cell == pieces.cells.end()) {
        const auto number = static_cast<std::size_t>(cut - cuts.begin());
        const EnrichedElement element = enriched_element(view, cuts, number, enrichment, Quadrature::polygons);
        std::vector<int> at = own;
        for (std::size_t a = 0; a < 4; ++a)
          if (element.enriched[a]) at.push_back(sets.at({nodes[a], cut->crack}).number);
        visit(element, at);
      } else {
        for (const Piece& piece : of_cell->pieces) {
          std::vector<int> at = own;
          std::array<double, 4> factor{};
          for (std::size_t a = 0; a < 4; ++a) {
            const auto row = sets.find({nodes[a], piece.set[a]});
            if (row == sets.end()) continue;
            factor[a] = shifted_step(opposite(row->second.side), row->second.side);
            at.push_back(row->second.number);
          }
          visit(piece_element(view.corners(c), piece, factor), at);
        }
      }
    }
  }

  Eigen::MatrixXd stiffness() const
  {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(2 * rows(), 2 * rows());
    for_each_element([&](const EnrichedElement& element, const std::vector<int>& at) {
      const EnrichedMatrix k =
          enriched_tangent(element, EnrichedVector::Zero(element.unknowns()), law, law::Kinematics::small);
      std::vector<int> unknowns;
      for (const int row : at) unknowns.insert(unknowns.end(), {2 * row, 2 * row + 1});
      sum(unknowns, unknowns) += k;
    });
    return sum;
  }

  /// Calls visit(element, side, rows of the corner values there, rows of the unknowns).
  template <class Visit> void for_each_part(Visit&& visit) const
  {
    for_each_element([&](const EnrichedElement& element, const std::vector<int>& at) {
      for (const Side side : kSides) {
        std::array<int, 4> moved{};
        std::size_t set = 4;
        for (std::size_t a = 0; a < 4; ++a) {
          const bool far = element.enriched[a] && element.factor(a, side) != 0.0;
          moved[a] = at[far ? set : a];
          set += element.enriched[a];
        }
        visit(element, side, moved, at);
      }
    });
  }

  /// Area in each body of what moves with each row, a quarter for each corner; those of sets behind those of nodes
  /// [m^2].
  template <class Body> std::vector<std::vector<double>> areas(int bodies, const Body& body) const
  {
    std::vector<std::vector<double>> all(static_cast<std::size_t>(rows()),
                                         std::vector<double>(static_cast<std::size_t>(bodies), 0.0));
    for_each_part([&](const EnrichedElement& element, Side side, const std::array<int, 4>& moved, const auto& at) {
      for (const PartPoint& point : element.cell.points(side))
        for (const int row : moved)
          all[static_cast<std::size_t>(row)][static_cast<std::size_t>(body(place(point, at)))] += 0.25 * point.area;
    });
    return all;
  }
  /// The body that each row moves most of.
  static std::vector<int> bodies_of(const std::vector<std::vector<double>>& areas)
  {
    std::vector<int> all;
    for (const std::vector<double>& of_row : areas)
      all.push_back(static_cast<int>(std::ranges::max_element(of_row) - of_row.begin()));
    return all;
  }
  /// @param at rows of an element
  Vector<2> place(const PartPoint& point, const std::vector<int>& at) const
  {
    Vector<2> x = Vector<2>::Zero();
    for (std::size_t a = 0; a < 4; ++a)
      x += point.shape[static_cast<Index>(a)] * points[static_cast<std::size_t>(at[a])];
    return x;
  }

  /// Unknowns of a displacement that is another one in each body.
  template <class Field> Eigen::VectorXd unknowns_of(const std::vector<int>& body_of, const Field& field) const
  {
    Eigen::VectorXd d(2 * rows());
    for (std::size_t v = 0; v < points.size(); ++v)
      d.segment<2>(static_cast<Index>(2 * v)) = field(points[v], body_of[v]);
    for (const auto& [key, row] : sets) {
      const Vector<2>& x = points[static_cast<std::size_t>(key.first)];
      d.segment<2>(2 * row.number) =
          (field(x, body_of[static_cast<std::size_t>(row.number)]) - d.segment<2>(2 * key.first)) /
          shifted_step(opposite(row.side), row.side);
    }
    return d;
  }

  law::Elastic law{10.0, 0.3, law::Plane::stress, 0.2};
  std::vector<Vector<2>> points;
  std::vector<std::array<Index, 4>> cells;
  std::vector<Index> active;
  std::vector<CellCut> cuts;
  Enrichment enrichment;
  Pieces pieces;
  std::map<std::pair<Index, int>, Row> sets;
  int lost = 0; ///< bodies that a node has too little of

private:
  const std::array<Index, 4>& cell(Index c) const { return cells[static_cast<std::size_t>(c)]; }
  void add(Index v, int code, Side side, const Vector<2>& at)
  {
    sets.try_emplace({v, code}, Row{side, at, static_cast<int>(points.size() + sets.size())});
  }
  /// Snaps cells of which slivers were given up and that have nodes without copies: true if any.
  bool snap_given_up(const std::set<Index>& zone, Snaps& snapped) const
  {
    bool any = false;
    for (std::size_t k = 0; k < cuts.size(); ++k) {
      const auto of_cell = std::ranges::find(pieces.cells, cuts[k].cell, &PiecedCell::cell);
      if (snapped[k] || of_cell == pieces.cells.end() || !of_cell->left()) continue;
      if (std::ranges::all_of(cell(cuts[k].cell), [&](Index v) { return zone.contains(v); })) continue;
      snapped[k] = of_cell->left();
      any = true;
    }
    return any;
  }
  /// The middle of the most that lies across a crack in a cell of a node.
  Vector<2> across(const NodeSupport& node) const
  {
    Vector<2> middle = points[static_cast<std::size_t>(node.node)];
    double most = 0.0;
    for (const CellCut& cut : cuts) {
      if (cut.crack != node.crack || std::ranges::find(cell(cut.cell), node.node) == cell(cut.cell).end()) continue;
      const geom::Split parts = geom::split(MeshView{cells, points, active}.corners(cut.cell), cut.distance);
      const geom::Polygon& far = node.side == Side::plus ? parts.minus : parts.plus;
      if (geom::area(far) <= most) continue;
      most = geom::area(far);
      middle.setZero();
      for (const Vector<2>& x : far) middle += x / static_cast<double>(far.size());
    }
    return middle;
  }

  /// As `EnrichedSets` finds them.
  std::vector<NearCell> find_cuts(double tolerance)
  {
    std::vector<NearCell> near;
    for (int k = 0; k < cracks_.size(); ++k) {
      const crack::Cuts found = crack::find_cuts(cracks_, k, {points, cells}, tolerance);
      for (const Index c : active) near.push_back({c, k});
      for (const crack::CutCell& cut : found.cells) {
        if (cut.kind == crack::CellKind::tip) continue;
        cuts.push_back({cut.cell, k, {}});
        for (std::size_t a = 0; a < 4; ++a)
          cuts.back().distance[a] = found.distance[static_cast<std::size_t>(cell(cut.cell)[a])];
      }
    }
    std::ranges::stable_sort(cuts, {}, &CellCut::cell);
    std::ranges::stable_sort(near, {}, &NearCell::cell);
    return near;
  }

  crack::CrackSet cracks_;
};

/// Displacements without energy.
inline int zeros(const Eigen::MatrixXd& k)
{
  const Eigen::VectorXd values = symmetric_eigenvalues(k);
  return static_cast<int>(
      std::ranges::count_if(values, [&](double v) { return v < 1e-10 * values[values.size() - 1]; }));
}
} // namespace pdx::xfem
