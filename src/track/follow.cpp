#include "pdx/track/follow.hpp"

#include "crack_ahead.hpp"
#include "laplacian.hpp"
#include "parted_cell.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <numbers>
#include <set>

namespace pdx::track {
namespace {
constexpr double kSnap = 1e-3; // of an edge: what is nearer to a corner or a line of the mesh is on it
constexpr double kAside =
    0.5; // spacings: a path that misses a cell by passing beyond a corner this near is on the corner
constexpr double kSteep = 0.5;  // cosine of a crack's angle to an axis, up to which it runs across it
constexpr double kKinked = 1.5; // horizons: what goes no farther straight on may have turned where it is known to end
constexpr double kTurns[] = {40.0, -40.0, 80.0, -80.0}; // degrees
constexpr double kTorn = 0.6;   // share of bonds broken along the first horizon of a crack that turned
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

/// Are both points on one side of the cell?
bool share_side(const CellBox& cell, const Vector<2>& a, const Vector<2>& b)
{
  for (int d = 0; d < 2; ++d)
    if (a[d] == b[d] && (a[d] == cell.lower[d] || a[d] == cell.upper[d])) return true;
  return false;
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
  const auto farther = [&](const Vector<2>& a, const Vector<2>& b) { // of equally near ones the one ahead
    const double more = std::abs(line.offset(a)) - std::abs(line.offset(b));
    return std::abs(more) > kSnap * cell.edge() ? more > 0.0 : line.along.dot(a - b) < 0.0;
  };
  const std::array<Vector<2>, 4> corners{cell.corner(0), cell.corner(1), cell.corner(2), cell.corner(3)};
  return *std::ranges::max_element(corners, farther);
}

class Follower {
public:
  Follower(const BondGraph& graph, std::span<const geom::Box<2>> boxes, const Line& start, Tracker tracker)
      : graph_(graph), boxes_(boxes), cells_(graph.lattice(), boxes), start_(start), tracker_(tracker)
  {
    snap_start();
  }

  Followed all()
  {
    while (next()) {
    }
    Followed followed;
    const auto first = path_.empty() ? cells_.around(start_.at) : std::vector{path_[0].cell};
    Vector<2> end = first.empty() ? in_metres(graph_.lattice(), start_.at) : metres(start_.at, first[0]);
    for (const auto& [cell, out] : path_) {
      followed.crossings.push_back({cell, end, metres(out, cell)});
      end = followed.crossings.back().out;
    }
    const Ahead ahead = tracker_ == Tracker::sides ? tip_ahead(graph_, now_) : ridge_ahead(graph_, now_);
    hangs_together_ = !path_.empty() || ahead.share > kTorn;
    for (std::size_t k = 1; k < ahead.way.size(); ++k)
      followed.beyond.push_back(in_metres(graph_.lattice(), ahead.way[k]));
    followed.tip = followed.beyond.empty() ? end : followed.beyond.back();
    followed.direction = ahead.tip.along;
    return followed;
  }
  bool hangs_together() const { return hangs_together_; } ///< is what was followed broken from the start on?

private:
  using Tried = std::set<std::size_t>;
  struct Left {
    std::size_t cell;
    Vector<2> out; // in spacings
  };

  /// What is next to a line of the mesh is on it.
  void snap_start()
  {
    for (const std::size_t c : cells_.around(start_.at, 1.0)) {
      const CellBox& cell = cells_[c];
      const double near = kSnap * cell.edge();
      for (int d = 0; d < 2; ++d)
        for (const double line : {cell.lower[d], cell.upper[d]})
          if (std::abs(start_.at[d] - line) <= near) start_.at[d] = line;
    }
    now_ = start_;
  }

  /// Goes on through one cell that is parted wholly. Is there one?
  bool next()
  {
    const Line here = now_;
    Tried tried;
    bool missed = false;
    for (auto cell = into(tried); cell; cell = into(tried)) {
      tried.insert(*cell);
      const auto found = parted(graph_, cells_[*cell], start_, now_.along, tracker_);
      const auto out = found ? leave(*cell, found->line) : std::nullopt;
      if (!found || (out && !go(*cell, *found, *out))) {
        now_.along = here.along;
        return false;
      }
      if (out) return true;
      now_.along = found->line.along; // it misses the cell
      missed = true;
      step_aside(cells_[*cell]);
    }
    if (missed && along_side()) return true;
    now_.along = here.along;
    return false;
  }

  std::optional<std::size_t> into(const Tried& tried) const
  {
    for (const std::size_t c : cells_.around(now_.at))
      if (!crossed_.contains(c) && !tried.contains(c) && leads_into(cells_[c], now_.at, now_.along)) return c;
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
    const bool along_mesh = line.along.cwiseAbs().minCoeff() <= 2.0 * kSnap;
    if (share_side(cell, out, now_.at) && !along_mesh) return std::nullopt;
    return out;
  }

  bool go(std::size_t cell, const Parted& found, const Vector<2>& out)
  {
    const Vector<2> way = out - now_.at;
    const Line chord = way.norm() < 1.0 ? found.line : Line{now_.at, way.normalized()};
    if (!parts_along(graph_, found.bodies, cells_[cell], chord)) return false;
    now_ = {out, found.line.along};
    path_.push_back({cell, out});
    crossed_.insert(cell);
    return true;
  }

  /// From beside a corner of a cell that the path does not enter, onto the corner. What was crossed before and would
  /// now be passed along a side is not crossed.
  void step_aside(const CellBox& missed)
  {
    for (int k = 0; k < 4; ++k) {
      const Vector<2> corner = missed.corner(k);
      if (corner == now_.at || (corner - now_.at).norm() > kAside) continue;
      std::size_t count = path_.size();
      while (count > 0 &&
             share_side(cells_[path_[count - 1].cell], corner, count > 1 ? path_[count - 2].out : start_.at))
        --count;
      if (count > 0 && !cells_[path_[count - 1].cell].holds(corner)) continue;
      path_.resize(count);
      if (count > 0) path_.back().out = corner;
      now_.at = corner;
      return;
    }
  }

  /// Where the lines of the cells on either side of a mesh line miss them, the path is the mesh line.
  bool along_side()
  {
    const int axis = std::abs(now_.along[0]) > std::abs(now_.along[1]) ? 0 : 1;
    if (std::abs(now_.along[1 - axis]) > kAlong) return false;
    now_.along = (now_.along[axis] > 0.0 ? 1.0 : -1.0) * Vector<2>::Unit(axis);
    const auto cell = into({});
    if (!cell) return false;
    const CellBox& box = cells_[*cell];
    if (now_.at[1 - axis] != box.lower[1 - axis] && now_.at[1 - axis] != box.upper[1 - axis]) return false;
    const auto found = parted(graph_, box, start_, now_.along, tracker_);
    Vector<2> out = now_.at;
    out[axis] = (now_.along[axis] > 0.0 ? box.upper : box.lower)[axis];
    const auto far = [&](const Vector<2>& x) { return std::abs(found->line.offset(x)) > kAside; };
    if (!found || far(now_.at) || far(out)) return false;
    return go(*cell, *found, out);
  }

  /// Of a point in a cell or on its border: what is on a side is on it exactly.
  Vector<2> metres(const Vector<2>& x, std::size_t cell) const
  {
    Vector<2> y = in_metres(graph_.lattice(), x);
    for (int d = 0; d < 2; ++d) {
      if (x[d] == cells_[cell].lower[d]) y[d] = boxes_[cell].lower[d];
      if (x[d] == cells_[cell].upper[d]) y[d] = boxes_[cell].upper[d];
    }
    return y;
  }

  const BondGraph& graph_;
  std::span<const geom::Box<2>> boxes_;
  Cells cells_;
  Line start_, now_;
  Tracker tracker_;
  std::vector<Left> path_;
  Tried crossed_; // cells that are done with
  bool hangs_together_ = true;
};
} // namespace

Followed follow(const BondGraph& graph, std::span<const geom::Box<2>> cells, const Vector<2>& from,
                const Vector<2>& direction, Tracker tracker)
{
  const auto follower = [&](double degrees) {
    const Eigen::Rotation2D<double> turn(degrees * std::numbers::pi / 180.0);
    return Follower(graph, cells, {in_spacings(graph.lattice(), from), turn * direction.normalized()}, tracker);
  };
  Followed best = follower(0.0).all();
  const auto way = [&](const Followed& found) { return (found.tip - from).norm(); };
  if (!best.crossings.empty() || way(best) > kKinked * graph.horizon()) return best;
  double least = std::max(kKinked * graph.horizon(), way(best) + graph.horizon());
  for (const double degrees : kTurns) {
    Follower turned = follower(degrees);
    Followed found = turned.all();
    if (way(found) < least || !turned.hangs_together()) continue;
    least = way(found);
    best = std::move(found);
  }
  return best;
}

std::optional<FoundCrack> follow_both_ways(const BondGraph& graph, std::span<const geom::Box<2>> cells,
                                           std::size_t cell, Tracker tracker)
{
  const CellBox box = in_spacings(graph.lattice(), cells[cell]);
  const Vector<2> middle = 0.5 * (box.lower + box.upper);
  for (const int axis : {0, 1}) {
    const Vector<2> heading = Vector<2>::Unit(axis);
    const Vector<2> far = middle - 2.0 * (box.size().sum() + graph.stencil().horizon / graph.lattice().dx) * heading;
    const auto found = parted(graph, box, {far, heading}, heading, tracker); // nothing lies behind its start
    if (!found || std::abs(found->line.along[axis]) < kSteep) continue;
    const Vector<2> along = found->line.along;
    const Vector<2> in = in_metres(graph.lattice(), way_out(box, {found->line.at, -along}));
    const Followed behind = follow(graph, cells, in, -along, tracker);
    const bool beside = behind.crossings.empty();
    const Vector<2> begin = beside ? in : behind.crossings.back().out;
    const Vector<2> onward = beside ? along : Vector<2>(behind.crossings.back().in - begin);
    Followed ahead = follow(graph, cells, begin, onward, tracker);
    if (!ahead.crossings.empty()) return FoundCrack{std::move(ahead), behind.tip};
  }
  return std::nullopt;
}
} // namespace pdx::track
