#include "crack_net.hpp"
#include "plane.hpp"

#include "pdx/geom/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::xfem {
namespace {
using geom::orientation;
constexpr double kPasses = 2.0;  // tolerances from a wall, or more by as much as vertices move: the wall passes there
constexpr double kInward = 1e-3; // of the tolerance

/// Where on a segment a place is nearest to: fraction of it, and how far from there [m].
struct Foot {
  double at, away;
};
Foot foot_of(const Vector<2>& x, const Vector<2>& a, const Vector<2>& b)
{
  const Vector<2> along = b - a;
  const double squared = along.squaredNorm();
  const double at = squared > 0.0 ? std::clamp((x - a).dot(along) / squared, 0.0, 1.0) : 0.0;
  return {at, (x - a - at * along).norm()};
}

bool cross_each_other(const Vector<2>& a, const Vector<2>& b, const Vector<2>& p, const Vector<2>& q)
{
  return orientation(a, b, p) * orientation(a, b, q) < 0 && orientation(p, q, a) * orientation(p, q, b) < 0;
}

/// Fraction of the first where it crosses the second.
double fraction_of_crossing(const Vector<2>& a, const Vector<2>& b, const Vector<2>& p, const Vector<2>& q)
{
  const double from = std::abs(cross_product(q - p, a - p)), to = std::abs(cross_product(q - p, b - p));
  return from + to > 0.0 ? from / (from + to) : 0.5;
}

/// Lines of cracks: mouths prolonged, ends on others moved there.
std::vector<crack::Polyline> lines_of(const crack::CrackSet& cracks)
{
  std::vector<crack::Polyline> lines;
  for (int k = 0; k < cracks.size(); ++k) lines.push_back(cracks.seen(k));
  for (const crack::Junction& junction : cracks.junctions()) {
    crack::Polyline& line = lines[static_cast<std::size_t>(junction.crack)];
    const crack::Polyline& other = lines[static_cast<std::size_t>(junction.other)];
    Vector<2>& end = cracks.points(junction.crack).front() == junction.at ? line.front() : line.back();
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 1 < other.size(); ++k) {
      const Foot foot = foot_of(junction.at, other[k], other[k + 1]);
      if (foot.away >= nearest) continue;
      nearest = foot.away;
      end = other[k] + foot.at * (other[k + 1] - other[k]);
    }
  }
  return lines;
}

template <class T> bool have_in_common(const std::vector<T>& a, const std::vector<T>& b, T& first)
{
  for (const T& one : a)
    if (std::ranges::find(b, one) != b.end()) {
      first = one;
      return true;
    }
  return false;
}
} // namespace

CrackNet::CrackNet(const MeshView& view, const crack::CrackSet& cracks, double tolerance) : tolerance_(tolerance)
{
  for (const Vector<2>& x : view.points) vertices_.push_back({x, {}, {}});
  lower_ = Vector<2>::Constant(std::numeric_limits<double>::infinity());
  upper_ = -lower_;
  for (const Index c : view.active) {
    Cell cell{view.cells[static_cast<std::size_t>(c)], {}, {}};
    for (std::size_t k = 0; k < 4; ++k) {
      Vertex& node = vertices_[static_cast<std::size_t>(cell.nodes[k])];
      node.cells.push_back(cells_.size());
      for (const std::size_t next : {(k + 1) % 4, (k + 3) % 4})
        if (const Edge edge = edge_between(cell.nodes[k], cell.nodes[next]);
            std::ranges::find(node.edges, edge) == node.edges.end())
          node.edges.push_back(edge);
      edges_[edge_between(cell.nodes[k], cell.nodes[(k + 1) % 4])].cells.push_back(cells_.size());
      lower_ = lower_.cwiseMin(node.at);
      upper_ = upper_.cwiseMax(node.at);
    }
    cells_.push_back(std::move(cell));
  }
  lower_.array() -= 2.0 * tolerance_;
  upper_.array() += 2.0 * tolerance_;
  find_segments(cracks);
  find_spots();
  for (Spot& spot : spots_) spot.vertex = vertex_at(spot.at);
  for (Segment& segment : segments_) {
    std::ranges::stable_sort(segment.spots, {}, &OnSegment::at);
    run(segment);
  }
  for (std::size_t c = 0; c < cells_.size(); ++c)
    while (refine(c)) {
    }
}

bool CrackNet::is_near(const Vector<2>& a, const Vector<2>& b) const
{
  return (a.cwiseMax(b).array() >= lower_.array()).all() && (a.cwiseMin(b).array() <= upper_.array()).all();
}

void CrackNet::find_segments(const crack::CrackSet& cracks)
{
  const std::vector<crack::Polyline> lines = lines_of(cracks);
  for (std::size_t k = 0; k < lines.size(); ++k)
    for (std::size_t j = 0; j + 1 < lines[k].size(); ++j)
      if (is_near(lines[k][j], lines[k][j + 1]))
        segments_.push_back({static_cast<int>(k), lines[k][j], lines[k][j + 1], {}});
}

std::size_t CrackNet::spot_at(const Vector<2>& x)
{
  for (std::size_t k = 0; k < spots_.size(); ++k)
    if ((spots_[k].at - x).norm() <= tolerance_) return k;
  spots_.push_back({x});
  return spots_.size() - 1;
}

void CrackNet::find_spots()
{
  for (Segment& segment : segments_) {
    segment.spots.push_back({0.0, spot_at(segment.from)});
    segment.spots.push_back({1.0, spot_at(segment.to)});
  }
  for (std::size_t i = 0; i < segments_.size(); ++i)
    for (std::size_t j = 0; j < segments_.size(); ++j) {
      Segment &a = segments_[i], &b = segments_[j];
      if (a.crack == b.crack) continue;
      for (const std::size_t end : {b.spots[0].spot, b.spots[1].spot})
        if (const Foot foot = foot_of(spots_[end].at, a.from, a.to); foot.away <= tolerance_)
          a.spots.push_back({foot.at, end});
      if (j < i || !cross_each_other(a.from, a.to, b.from, b.to)) continue;
      const double at = fraction_of_crossing(a.from, a.to, b.from, b.to);
      const Vector<2> x = a.from + at * (a.to - a.from);
      if (!is_near(x, x)) continue;
      const std::size_t spot = spot_at(x);
      a.spots.push_back({at, spot});
      b.spots.push_back({fraction_of_crossing(b.from, b.to, a.from, a.to), spot});
    }
}

/// A vertex for a place: a node, one on an edge, one inside a cell, or one outside of all.
int CrackNet::vertex_at(const Vector<2>& x)
{
  Vertex fresh{x, {}, {}};
  if (is_near(x, x)) {
    int node = -1;
    double least = tolerance_;
    const Edge* edge = nullptr;
    double from_edge = tolerance_, on_edge = 0.0;
    for (const auto& [ends, marks] : edges_) {
      const Vector<2>&a = point(ends.first), &b = point(ends.second);
      for (const Index end : {ends.first, ends.second})
        if (const double away = (point(end) - x).norm(); away <= least) {
          least = away;
          node = end;
        }
      if (const Foot foot = foot_of(x, a, b); foot.away <= from_edge) {
        from_edge = foot.away;
        on_edge = foot.at;
        edge = &ends;
      }
    }
    if (node >= 0) return node;
    if (edge) return mark(*edge, on_edge);
    for (std::size_t c = 0; c < cells_.size() && fresh.cells.empty(); ++c) {
      const std::array<Index, 4>& nodes = cells_[c].nodes;
      bool inside = true;
      for (std::size_t k = 0; k < 4 && inside; ++k)
        inside = orientation(point(nodes[k]), point(nodes[(k + 1) % 4]), x) > 0;
      if (inside) fresh.cells.push_back(c);
    }
  }
  for (const std::size_t c : fresh.cells) cells_[c].inside.push_back(static_cast<int>(vertices_.size()));
  vertices_.push_back(std::move(fresh));
  return static_cast<int>(vertices_.size()) - 1;
}

/// The vertex at a fraction of an edge.
int CrackNet::mark(const Edge& edge, double at)
{
  EdgeMarks& here = edges_.at(edge);
  const Vector<2> a = point(edge.first), along = point(edge.second) - a;
  const double length = along.norm();
  if (at * length <= tolerance_) return edge.first;
  if ((1.0 - at) * length <= tolerance_) return edge.second;
  for (const Mark& known : here.marks)
    if (std::abs(known.at - at) * length <= tolerance_) return known.vertex;
  const int vertex = static_cast<int>(vertices_.size());
  vertices_.push_back({a + at * along, {edge}, here.cells});
  here.marks.insert(std::ranges::upper_bound(here.marks, at, {}, &Mark::at), {at, vertex});
  return vertex;
}

/// Takes a segment from spot to spot, by the nodes and edges that it passes.
void CrackNet::run(const Segment& segment)
{
  for (std::size_t k = 0; k + 1 < segment.spots.size(); ++k) {
    const Spot &from = spots_[segment.spots[k].spot], &to = spots_[segment.spots[k + 1].spot];
    if (&from == &to) continue;
    const Vector<2>&p = from.at, &q = to.at;
    std::vector<Mark> passed{{0.0, from.vertex}, {1.0, to.vertex}};
    const auto pass_node = [&](Index node) {
      if (const Foot foot = foot_of(point(node), p, q); foot.away <= tolerance_) passed.push_back({foot.at, node});
    };
    if (is_near(p, q))
      for (const auto& [ends, marks] : edges_) {
        const Vector<2> a = point(ends.first), b = point(ends.second);
        if ((p.cwiseMax(q) - a.cwiseMin(b)).minCoeff() < -tolerance_ ||
            (a.cwiseMax(b) - p.cwiseMin(q)).minCoeff() < -tolerance_)
          continue;
        pass_node(ends.first);
        pass_node(ends.second);
        if (cross_each_other(a, b, p, q))
          passed.push_back({fraction_of_crossing(p, q, a, b), mark(ends, fraction_of_crossing(a, b, p, q))});
      }
    std::ranges::stable_sort(passed, {}, &Mark::at);
    for (std::size_t j = 0; j + 1 < passed.size(); ++j) run(segment.crack, passed[j].vertex, passed[j + 1].vertex);
  }
}

void CrackNet::run(int crack, int from, int to)
{
  for (const int vertex : {from, to}) vertices_[static_cast<std::size_t>(vertex)].cracks.insert(crack);
  if (from != to) add(from, to, {crack});
}

/// Adds a wall to the edge, or else to the cell, that both vertices have; to none outside.
void CrackNet::add(int from, int to, const std::set<int>& cracks)
{
  const Vertex &a = vertices_[static_cast<std::size_t>(from)], &b = vertices_[static_cast<std::size_t>(to)];
  Edge edge;
  std::size_t cell = 0;
  if (have_in_common(a.edges, b.edges, edge)) {
    edges_.at(edge).open.emplace_back(from, to);
    return;
  }
  if (!have_in_common(a.cells, b.cells, cell)) return;
  for (NetWall& wall : cells_[cell].walls)
    if (edge_between(wall.from, wall.to) == edge_between(from, to)) {
      wall.cracks.insert(cracks.begin(), cracks.end());
      return;
    }
  cells_[cell].walls.push_back({from, to, cracks});
}

std::vector<int> CrackNet::vertices_of(const Cell& cell) const
{
  std::vector<int> all(cell.nodes.begin(), cell.nodes.end());
  for (std::size_t k = 0; k < 4; ++k)
    for (const Mark& mark : edges_.at(edge_between(cell.nodes[k], cell.nodes[(k + 1) % 4])).marks)
      all.push_back(mark.vertex);
  all.insert(all.end(), cell.inside.begin(), cell.inside.end());
  return all;
}

/// Takes one wall through a vertex that it passes, or two walls through one where they cross. False: there is none.
/// Walls only become shorter.
bool CrackNet::refine(std::size_t number)
{
  const Cell& cell = cells_[number];
  const std::vector<int> all = vertices_of(cell);
  for (std::size_t k = 0; k < cell.walls.size(); ++k) {
    const Vector<2> a = point(cell.walls[k].from), b = point(cell.walls[k].to);
    const double length = (b - a).norm();
    for (const int vertex : all) {
      if (vertex == cell.walls[k].from || vertex == cell.walls[k].to) continue;
      const Vector<2>& x = point(vertex);
      if (foot_of(x, a, b).away > kPasses * tolerance_ || (x - a).norm() >= length || (x - b).norm() >= length)
        continue;
      split(number, k, vertex);
      return true;
    }
  }
  for (std::size_t k = 0; k < cell.walls.size(); ++k)
    for (std::size_t j = 0; j < k; ++j) {
      const NetWall one = cell.walls[k], two = cell.walls[j];
      if (!cross_each_other(point(one.from), point(one.to), point(two.from), point(two.to))) continue;
      const int vertex = crossing(number, one, two);
      split(number, k, vertex); // the later one first: what is added comes behind both
      split(number, j, vertex);
      return true;
    }
  return false;
}

void CrackNet::split(std::size_t number, std::size_t wall, int vertex)
{
  std::vector<NetWall>& walls = cells_[number].walls;
  const NetWall old = walls[wall];
  walls.erase(walls.begin() + static_cast<std::ptrdiff_t>(wall));
  vertices_[static_cast<std::size_t>(vertex)].cracks.insert(old.cracks.begin(), old.cracks.end());
  add(old.from, vertex, old.cracks);
  add(vertex, old.to, old.cracks);
}

/// A vertex inside the cell where two walls cross, whatever rounding says.
int CrackNet::crossing(std::size_t number, const NetWall& a, const NetWall& b)
{
  Cell& cell = cells_[number];
  const Vector<2>&from = point(a.from), &to = point(a.to);
  Vector<2> x = from + fraction_of_crossing(from, to, point(b.from), point(b.to)) * (to - from);
  Vector<2> middle = Vector<2>::Zero();
  for (const Index node : cell.nodes) middle += 0.25 * point(node);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector<2>&p = point(cell.nodes[k]), &q = point(cell.nodes[(k + 1) % 4]);
    if (cross_product((q - p).normalized(), x - p) < kInward * tolerance_)
      x += kInward * tolerance_ * (middle - x).normalized();
  }
  const int vertex = static_cast<int>(vertices_.size());
  cell.inside.push_back(vertex);
  vertices_.push_back({x, {}, {number}});
  return vertex;
}

std::vector<CrackNet::Mark> CrackNet::along(const Edge& edge) const
{
  std::vector<Mark> all{{0.0, edge.first}};
  const std::vector<Mark>& marks = edges_.at(edge).marks;
  all.insert(all.end(), marks.begin(), marks.end());
  all.push_back({1.0, edge.second});
  return all;
}

std::vector<NetShare> CrackNet::border(std::size_t number) const
{
  std::vector<NetShare> shares;
  const std::array<Index, 4>& nodes = cells_[number].nodes;
  for (std::size_t k = 0; k < 4; ++k) {
    const Edge edge = edge_between(nodes[k], nodes[(k + 1) % 4]);
    std::vector<Mark> all = along(edge);
    const auto place = [&all](int vertex) { return std::ranges::find(all, vertex, &Mark::vertex)->at; };
    std::vector<std::pair<double, double>> open;
    for (const auto& [a, b] : edges_.at(edge).open) open.push_back(std::minmax(place(a), place(b)));
    if (edge.first != nodes[k]) std::ranges::reverse(all);
    for (std::size_t j = 0; j + 1 < all.size(); ++j) {
      const bool back = edge.first != nodes[k];
      const double begin = all[j].at, end = all[j + 1].at, middle = 0.5 * (begin + end);
      const bool is_open =
          std::ranges::any_of(open, [&](const auto& part) { return part.first < middle && middle < part.second; });
      shares.push_back({all[j].vertex, all[j + 1].vertex, static_cast<int>(k), back ? 1.0 - begin : begin,
                        back ? 1.0 - end : end, is_open});
    }
  }
  return shares;
}

bool CrackNet::meet_on_border(std::size_t cell) const
{
  return std::ranges::any_of(border(cell), [this](const NetShare& share) {
    return vertices_[static_cast<std::size_t>(share.from)].cracks.size() > 1;
  });
}
} // namespace pdx::xfem
