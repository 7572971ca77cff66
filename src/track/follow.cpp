#include "pdx/track/follow.hpp"

#include "crack_ahead.hpp"
#include "parted_cell.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace pdx::track {
namespace {
constexpr double kSnap = 1e-3;  // of an edge: what is nearer to a corner or a line of the mesh is on it
constexpr double kAlong = 0.25; // slope up to which a line that misses a cell beside it is taken to run along its side

/// Cells in spacings, found by place.
class Cells {
public:
  Cells(const geom::Lattice<2>& lattice, std::span<const geom::Box<2>> boxes)
  {
    for (const geom::Box<2>& box : boxes) {
      cells_.push_back(in_spacings(lattice, box));
      pitch_ = std::max(pitch_, cells_.back().size().maxCoeff());
    }
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const auto [first, last] = std::pair(place(cells_[c].lower), place(cells_[c].upper));
      for (Index j = first.second; j <= last.second; ++j)
        for (Index i = first.first; i <= last.first; ++i) at_[{i, j}].push_back(c);
    }
  }
  const CellBox& operator[](std::size_t cell) const { return cells_[cell]; }

  /// All cells that have a point in them or on their border, or not farther than `margin`.
  std::vector<std::size_t> around(const Vector<2>& x, double margin = 0.0) const
  {
    std::set<std::size_t> found;
    for (int k = 0; k < 4; ++k) {
      const auto here = at_.find(place(CellBox{x.array() - margin, x.array() + margin}.corner(k)));
      if (here == at_.end()) continue;
      for (const std::size_t c : here->second)
        if (CellBox{cells_[c].lower.array() - margin, cells_[c].upper.array() + margin}.holds(x)) found.insert(c);
    }
    return {found.begin(), found.end()};
  }

private:
  std::pair<Index, Index> place(const Vector<2>& x) const
  {
    return {static_cast<Index>(std::floor(x[0] / pitch_)), static_cast<Index>(std::floor(x[1] / pitch_))};
  }
  std::vector<CellBox> cells_;
  double pitch_ = 1.0;
  std::map<std::pair<Index, Index>, std::vector<std::size_t>> at_;
};

/// Does a path at x, in the cell or on its border, go on into it? Along a side it is in the cell on its right.
bool leads_into(const CellBox& cell, const Vector<2>& x, const Vector<2>& along)
{
  const Vector<2> right = -left_of(along);
  for (int d = 0; d < 2; ++d) {
    const double inwards = x[d] == cell.lower[d] ? 1.0 : x[d] == cell.upper[d] ? -1.0 : 0.0;
    if (inwards == 0.0) continue;
    if (inwards * (std::abs(along[d]) > kSnap ? along[d] : right[d]) <= 0.0) return false;
  }
  return true;
}

/// Where a line leaves a cell; the nearest corner if it does not meet it.
Vector<2> way_out(const CellBox& cell, const Line& line)
{
  double first = -std::numeric_limits<double>::infinity(), last = std::numeric_limits<double>::infinity();
  int side = 0;
  bool meets = true;
  for (int d = 0; d < 2; ++d) {
    if (line.along[d] == 0.0) {
      meets = meets && line.at[d] >= cell.lower[d] && line.at[d] <= cell.upper[d];
      continue;
    }
    const bool up = line.along[d] > 0.0;
    const double in = ((up ? cell.lower : cell.upper)[d] - line.at[d]) / line.along[d];
    const double out = ((up ? cell.upper : cell.lower)[d] - line.at[d]) / line.along[d];
    first = std::max(first, in);
    if (out < last) {
      last = out;
      side = d;
    }
  }
  if (meets && first <= last) {
    Vector<2> x = (line.at + last * line.along).cwiseMax(cell.lower).cwiseMin(cell.upper);
    x[side] = (line.along[side] > 0.0 ? cell.upper : cell.lower)[side];
    return x;
  }
  Vector<2> nearest = cell.corner(0);
  for (int k = 1; k < 4; ++k)
    if (std::abs(line.offset(cell.corner(k))) < std::abs(line.offset(nearest))) nearest = cell.corner(k);
  return nearest;
}

class Follower {
public:
  Follower(const BondGraph& graph, std::span<const geom::Box<2>> boxes, const Line& start)
      : graph_(graph), boxes_(boxes), cells_(graph.lattice(), boxes), start_(start), now_(start)
  {
    snap_start();
  }

  Followed all()
  {
    Followed followed;
    Vector<2> in = metres(now_.at, std::nullopt);
    while (const auto cell = next()) {
      const Vector<2> out = metres(now_.at, cell);
      followed.crossings.push_back({*cell, in, out});
      in = out;
    }
    const Line tip = tip_ahead(graph_, now_);
    followed.tip = tip.at == now_.at ? in : in_metres(graph_.lattice(), tip.at);
    followed.direction = tip.along;
    return followed;
  }

private:
  /// What is next to a corner is on it; what is next to a line of the mesh and runs along it is on the line.
  void snap_start()
  {
    for (const std::size_t c : cells_.around(now_.at, 1.0)) {
      const CellBox& cell = cells_[c];
      const double near = kSnap * cell.edge();
      for (int k = 0; k < 4; ++k)
        if ((cell.corner(k) - now_.at).norm() <= near) now_.at = cell.corner(k);
      for (int d = 0; d < 2; ++d)
        for (const double line : {cell.lower[d], cell.upper[d]})
          if (std::abs(now_.at[d] - line) <= near) now_.at[d] = line;
    }
  }

  /// Goes on through one cell that is parted wholly, and says which; none if there is no such cell.
  std::optional<std::size_t> next()
  {
    const Line here = now_;
    std::set<std::size_t> tried = crossed_;
    bool missed = false; // by the line of a cell
    for (auto cell = into(tried); cell; cell = into(tried)) {
      tried.insert(*cell);
      const auto found = parted(graph_, cells_[*cell], start_, now_.along);
      if (!found) break;
      const auto out = leave(*cell, found->line);
      if (out) {
        now_ = here;
        return go(*cell, *found, *out);
      }
      now_.along = found->line.along;
      missed = true;
    }
    if (missed)
      if (const auto cell = along_side()) return cell;
    now_ = here;
    return std::nullopt;
  }

  std::optional<std::size_t> into(const std::set<std::size_t>& tried) const
  {
    for (const std::size_t c : cells_.around(now_.at))
      if (!tried.contains(c) && leads_into(cells_[c], now_.at, now_.along)) return c;
    return std::nullopt;
  }

  /// Where the path leaves the cell, put on corners; none if it does not go on in it.
  std::optional<Vector<2>> leave(std::size_t number, const Line& line) const
  {
    const CellBox& cell = cells_[number];
    const double near = kSnap * cell.edge();
    Vector<2> out = way_out(cell, line);
    const Vector<2> way = out - now_.at;
    for (int k = 0; k < 4; ++k) { // passed on the way
      const Vector<2> corner = cell.corner(k), to = corner - now_.at;
      if (to.norm() > near && to.dot(way) > 0.0 && to.dot(way) < way.squaredNorm() &&
          std::abs(cross(way, to)) <= near * way.norm() && to.norm() < (out - now_.at).norm())
        out = corner;
    }
    for (const std::size_t c : cells_.around(out))
      for (int k = 0; k < 4; ++k)
        if ((cells_[c].corner(k) - out).norm() <= near) out = cells_[c].corner(k);
    if ((out - now_.at).dot(line.along) <= near) return std::nullopt;
    return out;
  }

  std::optional<std::size_t> go(std::size_t cell, const Parted& found, const Vector<2>& out)
  {
    const Vector<2> way = out - now_.at;
    const Line chord = way.norm() < 1.0 ? found.line : Line{now_.at, way.normalized()};
    if (!parts_along(graph_, found.bodies, cells_[cell], chord)) return std::nullopt;
    now_ = {out, found.line.along};
    crossed_.insert(cell);
    return cell;
  }

  /// Where the lines of the cells on either side of a mesh line miss them, the path is the mesh line.
  std::optional<std::size_t> along_side()
  {
    const int axis = std::abs(now_.along[0]) > std::abs(now_.along[1]) ? 0 : 1;
    if (std::abs(now_.along[1 - axis]) > kAlong) return std::nullopt;
    now_.along = (now_.along[axis] > 0.0 ? 1.0 : -1.0) * Vector<2>::Unit(axis);
    const auto cell = into(crossed_);
    if (!cell) return std::nullopt;
    const CellBox& box = cells_[*cell];
    if (now_.at[1 - axis] != box.lower[1 - axis] && now_.at[1 - axis] != box.upper[1 - axis]) return std::nullopt;
    const auto found = parted(graph_, box, start_, now_.along);
    if (!found) return std::nullopt;
    Vector<2> out = now_.at;
    out[axis] = (now_.along[axis] > 0.0 ? box.upper : box.lower)[axis];
    return go(*cell, *found, out);
  }

  /// Of a point in a cell or on its border: exactly the cell's corner or side.
  Vector<2> metres(const Vector<2>& x, std::optional<std::size_t> cell) const
  {
    Vector<2> y = in_metres(graph_.lattice(), x);
    const auto touching = cell ? std::vector<std::size_t>{*cell} : cells_.around(x);
    if (touching.empty()) return y;
    const CellBox& box = cells_[touching[0]];
    for (int d = 0; d < 2; ++d) {
      if (x[d] == box.lower[d]) y[d] = boxes_[touching[0]].lower[d];
      if (x[d] == box.upper[d]) y[d] = boxes_[touching[0]].upper[d];
    }
    return y;
  }

  const BondGraph& graph_;
  std::span<const geom::Box<2>> boxes_;
  Cells cells_;
  Line start_, now_;
  std::set<std::size_t> crossed_;
};
} // namespace

Followed follow(const BondGraph& graph, std::span<const geom::Box<2>> cells, const Vector<2>& from,
                const Vector<2>& direction)
{
  return Follower(graph, cells, {in_spacings(graph.lattice(), from), direction.normalized()}).all();
}
} // namespace pdx::track
