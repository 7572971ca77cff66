// Where cracks meet: each body of a plate that they cut has displacements of its own, whatever runs through one cell.
#include "pdx/base/symmetric.hpp"
#include "pdx/crack/cut_cells.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/xfem/enriched_kernel.hpp"
#include "pdx/xfem/pieces.hpp"

#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <random>
#include <set>

using namespace pdx;
using namespace pdx::xfem;

namespace {
constexpr double kFar = 10.0; // beyond any plate here [m]

/// Straight half-lines from one place, in order of angles: bodies lie between them.
struct Star {
  Vector<2> middle;
  std::vector<double> angles;

  Vector<2> along(std::size_t k) const { return {std::cos(angles[k]), std::sin(angles[k])}; }
  int body(const Vector<2>& x) const
  {
    const double angle = std::atan2(x.y() - middle.y(), x.x() - middle.x());
    for (std::size_t k = 0; k < angles.size(); ++k)
      if (angle < angles[k]) return static_cast<int>(k);
    return 0;
  }
};

/// n x n cells of a square of side 1, cut by cracks that meet in the middle one.
class Plate {
public:
  Plate(int n, std::vector<crack::Polyline> lines, double least_share = 1e-4)
      : cracks_(std::move(lines), geom::Box<2>{{0.0, 0.0}, {1.0, 1.0}})
  {
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.emplace_back(i / static_cast<double>(n), j / static_cast<double>(n));
    const auto node = [n](int i, int j) { return static_cast<Index>(i + (n + 1) * j); };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        active.push_back(static_cast<Index>(cells.size()));
        cells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
      }
    std::vector<PieceCut> all = all_cuts(1e-9 / n);
    for (const PieceCut& cut : all)
      if (cut.entry < 0) cuts.push_back({cut.cell, cut.crack, cut.distance});
    const MeshView view{cells, points, active};
    enrichment = enrich(view, cuts, {least_share, Quadrature::polygons});
    for (std::size_t k = 0, at = 0; k < all.size(); ++k)
      if (all[k].entry < 0) all[k].snapped = enrichment.snapped[at++];
    std::set<Index> zone; // nodes of cells that several cracks cut
    for (std::size_t k = 0; k + 1 < all.size(); ++k)
      if (all[k].cell == all[k + 1].cell) zone.insert(cell(all[k].cell).begin(), cell(all[k].cell).end());
    std::vector<Index> around;
    for (const Index c : active)
      if (std::ranges::any_of(cell(c), [&](Index v) { return zone.contains(v); })) around.push_back(c);
    std::erase_if(all, [&](const PieceCut& cut) { return !std::ranges::binary_search(around, cut.cell); });
    pieces = cut_in_pieces({cells, points, around}, all, least_share, cracks_.size());
    for (const CopiedNode& copied : pieces.nodes) {
      lost += copied.lost;
      for (const NodeCopy& copy : copied.copies) add(copied.node, copy.code, copy.side, copy.at);
    }
    for (const NodeSupport& support : enrichment.nodes)
      if (!zone.contains(support.node)) add(support.node, support.crack, support.side, across(support));
    lost += static_cast<int>(enrichment.dropped.size());
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
          enriched_tangent(element, EnrichedVector::Zero(element.unknowns()), law, fem::Kinematics::small);
      std::vector<int> unknowns;
      for (const int row : at) unknowns.insert(unknowns.end(), {2 * row, 2 * row + 1});
      sum(unknowns, unknowns) += k;
    });
    return sum;
  }

  /// Area that moves with each row, those of sets behind those of nodes [m^2].
  std::vector<double> areas() const
  {
    std::vector<double> all(static_cast<std::size_t>(rows()), 0.0);
    for_each_element([&](const EnrichedElement& element, const std::vector<int>& at) {
      for (const Side side : kSides) {
        double area = 0.0;
        for (const PartPoint& point : element.cell.points(side)) area += point.area;
        std::size_t set = 4;
        for (std::size_t a = 0; a < 4; ++a) {
          const bool far = element.enriched[a] && element.factor(a, side) != 0.0;
          all[static_cast<std::size_t>(at[far ? set : a])] += 0.25 * area;
          set += element.enriched[a];
        }
      }
    });
    return all;
  }

  /// Unknowns of a displacement that is another one in each body.
  template <class Body, class Field> Eigen::VectorXd unknowns_of(const Body& body, const Field& field) const
  {
    Eigen::VectorXd d(2 * rows());
    for (std::size_t v = 0; v < points.size(); ++v)
      d.segment<2>(static_cast<Index>(2 * v)) = field(points[v], body(points[v]));
    for (const auto& [key, row] : sets) {
      const Vector<2>& x = points[static_cast<std::size_t>(key.first)];
      d.segment<2>(2 * row.number) =
          (field(x, body(row.at)) - d.segment<2>(2 * key.first)) / shifted_step(opposite(row.side), row.side);
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
  /// The middle of what lies across a crack in a cell of a node.
  Vector<2> across(const NodeSupport& node) const
  {
    for (const CellCut& cut : cuts) {
      if (cut.crack != node.crack || std::ranges::find(cell(cut.cell), node.node) == cell(cut.cell).end()) continue;
      geom::Split parts = geom::split(MeshView{cells, points, active}.corners(cut.cell), cut.distance);
      Vector<2> sum = Vector<2>::Zero();
      const geom::Polygon& far = node.side == Side::plus ? parts.minus : parts.plus;
      for (const Vector<2>& x : far) sum += x;
      if (geom::area(far) > 1e-6) return sum / static_cast<double>(far.size());
    }
    return points[static_cast<std::size_t>(node.node)];
  }

  /// As `EnrichedSets` finds them.
  std::vector<PieceCut> all_cuts(double tolerance) const
  {
    std::vector<PieceCut> found_cuts;
    for (int k = 0; k < cracks_.size(); ++k) {
      const crack::Cuts found = crack::find_cuts(cracks_, k, {points, cells}, tolerance);
      for (const crack::CutCell& cell : found.cells) {
        PieceCut cut{cell.cell, k, {}, std::nullopt, -1, -1, {0.0, 0.0}};
        for (std::size_t a = 0; a < 4; ++a)
          cut.distance[a] = found.distance[static_cast<std::size_t>(cells[static_cast<std::size_t>(cell.cell)][a])];
        if (cell.kind == crack::CellKind::tip) {
          const auto junction = std::ranges::find(cracks_.junctions(), k, &crack::Junction::crack);
          if (junction == cracks_.junctions().end() || !cell.edges) continue;
          cut.entry = std::countr_zero(cell.edges);
          cut.other = junction->other;
          cut.end = junction->at;
        }
        found_cuts.push_back(cut);
      }
    }
    std::ranges::stable_sort(found_cuts, {}, &PieceCut::cell);
    return found_cuts;
  }

  crack::CrackSet cracks_;
};

int zeros(const Eigen::MatrixXd& k)
{
  const Eigen::VectorXd values = symmetric_eigenvalues(k);
  return static_cast<int>(
      std::ranges::count_if(values, [&](double v) { return v < 1e-10 * values[values.size() - 1]; }));
}

/// Three cracks that meet, or one with a branch where it bends.
std::vector<crack::Polyline> lines_of(const Star& star, bool bent)
{
  const auto out = [&](std::size_t k) { return Vector<2>(star.middle + kFar * star.along(k)); };
  if (bent) return {{out(0), star.middle, out(1)}, {out(2), star.middle}};
  return {{out(0), star.middle}, {out(1), star.middle}, {out(2), star.middle}};
}

const Star kY{{0.52, 0.49}, {-2.4, 0.3, 2.0}};
} // namespace

TEST(Pieces, AYInOneCellHasTwelveFunctionsAndNineRigidMotions)
{
  for (const bool bent : {false, true}) {
    const Plate cell(1, lines_of(kY, bent));
    ASSERT_EQ(cell.pieces.cells.size(), 1u);
    EXPECT_EQ(cell.pieces.cells[0].pieces.size(), 3u);
    EXPECT_EQ(cell.rows(), 12); // 4 nodes, a copy of each in each of 3 pieces
    EXPECT_EQ(zeros(cell.stiffness()), 9);
    const Plate plate(3, lines_of(kY, bent));
    EXPECT_EQ(zeros(plate.stiffness()), 9);
  }
}

TEST(Pieces, TwelveFunctionsAreIndependent)
{
  const Plate cell(1, lines_of(kY, false));
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(cell.rows(), cell.rows());
  cell.for_each_element([&](const EnrichedElement& element, const std::vector<int>& at) {
    for (const PartPoint& point : element.cell.points(Side::plus)) {
      Eigen::VectorXd values = Eigen::VectorXd::Zero(cell.rows());
      std::size_t set = 4;
      for (std::size_t a = 0; a < 4; ++a) {
        values[at[a]] += point.shape[static_cast<Index>(a)];
        if (element.enriched[a])
          values[at[set++]] += element.factor(a, Side::plus) * point.shape[static_cast<Index>(a)];
      }
      gram += point.area * values * values.transpose();
    }
  });
  EXPECT_EQ(zeros(gram), 0); // rank 12 in each direction
}

TEST(Pieces, BodiesStretchAsTheyLike)
{
  const auto field = [](const Vector<2>& x, int body) {
    Tensor<2> gradient;
    gradient << 1e-3 * (body + 1), 2e-3 * body, -1e-3, 3e-3 - 1e-3 * body;
    return Vector<2>(gradient * x + Vector<2>(0.1 * body, -0.2 * body));
  };
  for (const bool bent : {false, true})
    for (const int n : {1, 3}) {
      const Plate plate(n, lines_of(kY, bent));
      const Eigen::VectorXd d = plate.unknowns_of([](const Vector<2>& x) { return kY.body(x); }, field);
      double worst = 0.0;
      plate.for_each_element([&](const EnrichedElement& element, const std::vector<int>& at) {
        EnrichedVector local(element.unknowns());
        for (std::size_t k = 0; k < at.size(); ++k)
          local.segment<2>(static_cast<Index>(2 * k)) = d.segment<2>(2 * at[k]);
        const SideMap map = side_map(element, Side::plus);
        const fem::ElementVector corners = map * local;
        for (const PartPoint& point : element.cell.points(Side::plus)) {
          Vector<2> x = Vector<2>::Zero(), u = Vector<2>::Zero();
          const auto& nodes = at;
          for (std::size_t a = 0; a < 4; ++a) {
            x += point.shape[static_cast<Index>(a)] * plate.points[static_cast<std::size_t>(nodes[a])];
            u += point.shape[static_cast<Index>(a)] * corners.segment<2>(static_cast<Index>(2 * a));
          }
          worst = std::max(worst, (u - field(x, kY.body(x))).norm());
        }
      });
      EXPECT_LT(worst, 1e-12);
    }
}

namespace {
/// The part of the unit square left of a line from a place along a direction.
geom::Polygon left_of(const geom::Polygon& shape, const Vector<2>& from, const Vector<2>& along)
{
  std::vector<double> distance;
  for (const Vector<2>& x : shape) distance.push_back(along.x() * (x - from).y() - along.y() * (x - from).x());
  return shape.empty() ? shape : geom::split(shape, distance).plus;
}
const geom::Polygon kSquare{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};

/// Areas of the bodies of a star.
std::vector<double> areas_of(const Star& star)
{
  std::vector<double> areas(star.angles.size());
  double others = 0.0;
  for (std::size_t k = 1; k < areas.size(); ++k) {
    if (star.angles[k] - star.angles[k - 1] >= std::numbers::pi) return {}; // not convex
    areas[k] = geom::area(left_of(left_of(kSquare, star.middle, star.along(k - 1)), star.middle, -star.along(k)));
    others += areas[k];
  }
  areas[0] = 1.0 - others;
  return areas;
}
} // namespace

TEST(Pieces, MassIsThatOfTheBodies)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0.35, 0.65), turn(-std::numbers::pi, std::numbers::pi);
  int kinds[3] = {};
  for (int number = 0; number < 200; ++number) {
    const int n = number % 2 ? 3 : 1, kind = number / 2 % 3; // Y, T, X
    Star star{{place(random), place(random)}, {turn(random), turn(random), turn(random)}};
    std::vector<crack::Polyline> lines;
    if (kind >= 1) { // T and X: a straight line, a branch, and its other half
      star.angles = {star.angles[0], star.angles[1]};
      star.angles[0] = star.angles[0] > 0.0 ? star.angles[0] - std::numbers::pi : star.angles[0];
      star.angles.push_back(star.angles[0] + std::numbers::pi);
      if (kind == 2) star.angles.push_back(star.angles[1] + (star.angles[1] > 0.0 ? -1.0 : 1.0) * std::numbers::pi);
      const Vector<2> line = kFar * star.along(0), branch = kFar * star.along(1);
      lines = {{star.middle + line, star.middle - line}, {star.middle + branch, star.middle}};
      if (kind == 2) lines[1][1] -= branch;
    } else {
      lines = lines_of(star, false);
    }
    std::ranges::sort(star.angles);
    double narrowest = 2.0 * std::numbers::pi + star.angles[0] - star.angles.back();
    for (std::size_t k = 1; k < star.angles.size(); ++k)
      narrowest = std::min(narrowest, star.angles[k] - star.angles[k - 1]);
    const std::vector<double> areas = areas_of(star);
    if (areas.empty() || narrowest < 0.1) continue;
    const Plate plate(n, lines);
    if (plate.lost > 0) continue;
    ++kinds[kind];
    const std::vector<double> all = plate.areas();
    std::vector<double> mine(star.angles.size(), 0.0);
    for (std::size_t v = 0; v < plate.points.size(); ++v)
      mine[static_cast<std::size_t>(star.body(plate.points[v]))] += all[v];
    for (const auto& [key, row] : plate.sets)
      mine[static_cast<std::size_t>(star.body(row.at))] += all[static_cast<std::size_t>(row.number)];
    for (std::size_t k = 0; k < areas.size(); ++k) EXPECT_NEAR(mine[k], areas[k], 1e-12) << "number " << number;
  }
  for (const int many : kinds) EXPECT_GT(many, 15);
}

TEST(Pieces, ConditionStaysBoundedNearNodesAndEdges)
{
  for (const double away : {1e-1, 1e-2, 1e-3, 1e-5, 1e-7, 1e-10, 0.0}) {
    const Vector<2> corner(1.0 / 3.0, 1.0 / 3.0);
    for (const bool diagonal : {false, true}) {
      const Vector<2> middle = corner + Vector<2>(away, diagonal ? away : 0.12);
      const Plate plate(3, {{{-1.0, middle.y()}, {2.0, middle.y()}}, {{middle.x(), -1.0}, {middle.x(), 2.0}}});
      const Eigen::VectorXd values = symmetric_eigenvalues(plate.stiffness());
      const int free = zeros(plate.stiffness());
      EXPECT_EQ(free, 12) << away; // four bodies
      EXPECT_LT(values[values.size() - 1] / values[free], 1e7) << away;
    }
  }
}

TEST(Pieces, CracksAlongOneEdgeAndManyInOneCell)
{
  // Two that cross one edge, and three lines through one cell: bodies in a row, and seven of three lines.
  const Plate rows(3, {{{-1.0, 0.45}, {2.0, 0.45}}, {{-1.0, 0.52}, {2.0, 0.56}}});
  EXPECT_EQ(zeros(rows.stiffness()), 9);
  const Plate seven(3, {{{-1.0, 0.4}, {2.0, 0.4}}, {{-0.345, -1.0}, {1.31, 2.0}}, {{1.345, -1.0}, {-0.31, 2.0}}});
  EXPECT_EQ(seven.pieces.cells[4].pieces.size(), 7u);
  EXPECT_EQ(zeros(seven.stiffness()), 21);
}
