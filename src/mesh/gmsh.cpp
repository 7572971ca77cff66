#include "pdx/mesh/gmsh.hpp"

#include "gmsh_scan.hpp"
#include "pdx/base/error.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <set>

namespace pdx::mesh {
namespace {
constexpr const char* kUnnamed = "unnamed";

double cross(const Vector<2>& a, const Vector<2>& b) { return a[0] * b[1] - a[1] * b[0]; }

/// Makes a CellList of what the file says.
class Assembly {
public:
  Assembly(const GmshSource& source, const GmshFile& file) : source_(source), file_(file) {}

  CellList make()
  {
    take_cells();
    take_points();
    for (std::size_t c = 0; c < list_.cells.size(); ++c) orient(c);
    find_edges();
    name_edges();
    return std::move(list_);
  }

private:
  /// Seen from its cell, from begin to end.
  struct Edge {
    Index low, high;
    bool rising; ///< from low to high
    Index cell;
    auto key() const { return std::pair(low, high); }
  };

  [[noreturn]] void refuse_cell(std::size_t c, const std::string& what) const
  {
    source_.refuse_at(places_[c], fmt::format("cell {} (counted from 1) {}", c + 1, what));
  }

  /// A cell in several physical surfaces stands in a 2.2 file once for each.
  std::vector<bool> repeated() const
  {
    std::vector<std::pair<std::array<std::size_t, 4>, std::size_t>> order;
    for (std::size_t c = 0; c < file_.cells.size(); ++c) {
      auto nodes = file_.cells[c].nodes;
      std::sort(nodes.begin(), nodes.end());
      order.emplace_back(nodes, c);
    }
    std::sort(order.begin(), order.end());
    std::vector<bool> again(order.size(), false);
    for (std::size_t k = 1; k < order.size(); ++k) {
      if (order[k].first != order[k - 1].first) continue;
      const GmshFile::Cell &first = file_.cells[order[k - 1].second], &second = file_.cells[order[k].second];
      if (first.entity != second.entity || first.group == second.group)
        source_.refuse_at(second.place, "a cell with the same nodes was there before: remove duplicate surfaces");
      again[order[k].second] = true;
    }
    return again;
  }

  void take_cells()
  {
    constexpr std::size_t kMostInFile = std::numeric_limits<Index>::max() / 8; // edges and vertices are numbered too
    const std::vector<bool> again = repeated();
    vertex_.assign(file_.nodes.size(), -1);
    for (std::size_t c = 0; c < file_.cells.size(); ++c) {
      if (again[c]) continue;
      for (const std::size_t node : file_.cells[c].nodes) vertex_[node] = 0;
      places_.push_back(file_.cells[c].place);
    }
    if (places_.empty())
      throw UserError(fmt::format("{} has no four-node cells: mesh the surface and save its elements", source_.name()));
    if (places_.size() > kMostInFile)
      throw UserError(fmt::format("{} has {} cells, more than the {} that can be numbered", source_.name(),
                                  places_.size(), kMostInFile));
    Index used = 0;
    for (Index& v : vertex_)
      if (v == 0) v = used++;
    for (std::size_t c = 0; c < file_.cells.size(); ++c) {
      if (again[c]) continue;
      std::array<Index, 4> cell{};
      for (std::size_t k = 0; k < 4; ++k) cell[k] = vertex_[file_.cells[c].nodes[k]];
      list_.cells.push_back(cell);
    }
  }

  void take_points()
  {
    constexpr double far = std::numeric_limits<double>::infinity();
    Vector<3> lower = Vector<3>::Constant(far), upper = -lower;
    for (std::size_t k = 0; k < vertex_.size(); ++k) {
      if (vertex_[k] < 0) continue;
      const Vector<3>& x = file_.nodes[k].x;
      lower = lower.cwiseMin(x);
      upper = upper.cwiseMax(x);
      list_.points.push_back(x.head<2>());
    }
    if (upper[2] - lower[2] > 1e-9 * (upper - lower).head<2>().maxCoeff())
      throw UserError(fmt::format("{}: z runs from {} to {} m: the mesh must lie in one plane z = constant",
                                  source_.name(), lower[2], upper[2]));
  }

  /// Turns a clockwise cell; refuses one whose corners do not all bend to the left then.
  void orient(std::size_t c)
  {
    auto& cell = list_.cells[c];
    const auto x = [&](std::size_t k) { return list_.points[static_cast<std::size_t>(cell[k % 4])]; };
    if (cross(x(2) - x(0), x(3) - x(1)) < 0.0) std::swap(cell[1], cell[3]);
    const double scale = std::max((x(2) - x(0)).squaredNorm(), (x(3) - x(1)).squaredNorm());
    for (std::size_t k = 0; k < 4; ++k)
      if (!(cross(x(k + 1) - x(k), x(k + 3) - x(k)) > 1e-12 * scale))
        refuse_cell(c, fmt::format("is degenerate at ({}, {}) m: its corner there is not below 180 degrees; mend the "
                                   "mesh",
                                   x(k)[0], x(k)[1]));
  }

  void find_edges()
  {
    for (std::size_t c = 0; c < list_.cells.size(); ++c)
      for (std::size_t k = 0; k < 4; ++k) {
        const Index a = list_.cells[c][k], b = list_.cells[c][(k + 1) % 4];
        edges_.push_back({std::min(a, b), std::max(a, b), a < b, static_cast<Index>(c)});
      }
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) {
      return std::tuple(a.low, a.high, a.rising, a.cell) < std::tuple(b.low, b.high, b.rising, b.cell);
    });
    for (std::size_t k = 1; k < edges_.size(); ++k)
      if (edges_[k].key() == edges_[k - 1].key() && edges_[k].rising == edges_[k - 1].rising)
        refuse_cell(static_cast<std::size_t>(edges_[k].cell),
                    fmt::format("lies on the same side of an edge as cell {}: remove duplicate surfaces and folds",
                                edges_[k - 1].cell + 1));
  }

  bool on_boundary(std::size_t k) const
  {
    return (k == 0 || edges_[k].key() != edges_[k - 1].key()) &&
           (k + 1 == edges_.size() || edges_[k].key() != edges_[k + 1].key());
  }

  void name_edges()
  {
    std::map<std::string, std::set<std::size_t>> named;
    std::vector<bool> has_name(edges_.size(), false);
    for (const GmshFile::Line& line : file_.lines) {
      const auto name = file_.curve_names.find(line.group);
      const auto [low, high] = std::minmax(vertex_[line.ends[0]], vertex_[line.ends[1]]);
      if (name == file_.curve_names.end() || low < 0) continue;
      const auto edge = std::lower_bound(edges_.begin(), edges_.end(), std::pair(low, high),
                                         [](const Edge& e, const auto& key) { return e.key() < key; });
      if (edge == edges_.end() || edge->key() != std::pair(low, high)) continue;
      const auto k = static_cast<std::size_t>(edge - edges_.begin());
      if (!on_boundary(k)) continue;
      named[name->second].insert(k);
      has_name[k] = true;
    }
    for (std::size_t k = 0; k < edges_.size(); ++k)
      if (on_boundary(k) && !has_name[k]) named[kUnnamed].insert(k);
    for (const auto& [name, edges] : named) {
      for (const std::size_t k : edges)
        list_.edges.push_back({{edges_[k].low, edges_[k].high}, static_cast<Index>(list_.boundaries.size())});
      list_.boundaries.push_back(name);
    }
  }

  const GmshSource& source_;
  const GmshFile& file_;
  CellList list_;
  std::vector<std::size_t> places_; // of list_.cells in the file
  std::vector<Index> vertex_;       // per node of the file, -1 if no cell has it
  std::vector<Edge> edges_;         // of all cells, sorted
};
} // namespace

CellList read_gmsh(const std::string& file)
{
  GmshSource source(file);
  const GmshFile content = scan_gmsh(source);
  return Assembly(source, content).make();
}
} // namespace pdx::mesh
