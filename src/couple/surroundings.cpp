#include "pdx/couple/surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::couple {
namespace {
constexpr double kOnSide = 1e-5; // a point this far from a side, in units of dx, lies on it: sides fit to 1e-6
constexpr double kTiny = 1e-7;   // a part of an edge as short as this, in units of dx, is none

struct Interval {
  double begin, end;
};
} // namespace

/// The displacement of mesh edges at the border of a patch, as seen from a point `from` of the patch: where a crack
/// cuts the element behind, that of the side on which `from` lies.
struct Surroundings::Trace {
  const std::vector<Edge>& edges;
  const crack::CrackSet* cracks;
  const crack::CrackSet* seams;
  Vector<2> from;     // [m]
  double face;        // the side's coordinate [m]
  Eigen::Index along; // axis of the side

  bool add(Host& host, const Edge& edge, std::size_t end, double weight) const
  {
    if (!host.add(edge.rows[end], weight)) return false;
    if (edge.crack < 0) return true;
    const xfem::Side of_from = xfem::side_of(cracks->side(edge.crack, from));
    const xfem::Side side = edge.snapped ? xfem::side_of(edge.snapped) : of_from;
    host.across = host.across || side != of_from;
    host.sided = host.sided || !edge.snapped;
    if (edge.sets[end] < 0) return true;
    const double factor = xfem::shifted_step(side, edge.node_side[end]);
    return factor == 0.0 || host.cross(edge.rows[end], edge.sets[end], weight, factor);
  }

  const Edge* edge_at(double s) const
  {
    auto edge = std::upper_bound(edges.begin(), edges.end(), s, [](double v, const auto& e) { return v < e.begin; });
    if (edge != edges.begin()) --edge;
    return &*edge;
  }

  Vector<2> point(double s) const
  {
    Vector<2> x;
    x[along] = s;
    x[1 - along] = face;
    return x;
  }
  /// Edges that meet in a node, not in two of the same place.
  static bool joined(const Edge& before, const Edge& after) { return before.rows[1] == after.rows[0]; }

  /// Is s on an edge that hangs together with the patch at `from`? Not where the mesh is parted from the patch or ends
  /// between two edges, nor at the end of edges whose side of a seam is not that of `from` (if `seen` from there).
  bool reaches(double s, double near, bool seen) const
  {
    const Edge *const first = edges.data(), *const last = first + edges.size() - 1;
    const Edge* edge = edge_at(s);
    if (s > edge->end + near && edge != last) ++edge;
    if (s < edge->begin - near || s > edge->end + near) return false;
    const bool begins = s < edge->begin + near && (edge == first || (edge - 1)->end < edge->begin - near);
    const bool ends = s > edge->end - near && (edge == last || (edge + 1)->begin > edge->end + near);
    return !seen || !seams || !(begins || ends) || !seams->cuts(from, point(0.5 * (edge->begin + edge->end)));
  }

  /// Where the nodes are doubled at s, the edge on whose side of the seam `from` lies.
  const Edge* edge_beside(double s, bool& parted) const
  {
    const Edge* edge = edge_at(s);
    const double near = 1e-6 * (edge->end - edge->begin);
    const Edge *before = edge, *after = edge;
    if (s - edge->begin < near && edge != edges.data()) --before;
    if (edge->end - s < near && edge + 1 != edges.data() + edges.size()) ++after;
    parted = seams && before != after && !joined(*before, *after) && after->begin - before->end < near;
    if (!parted) return edge;
    return seams->cuts(from, point(0.5 * (after->begin + after->end))) ? before : after;
  }

  /// The linear trace at s itself.
  void at(double s, Host& host) const
  {
    host.clear();
    const Edge* edge = edge_beside(s, host.sided);
    const double t = std::clamp((s - edge->begin) / (edge->end - edge->begin), 0.0, 1.0);
    static_assert(Host::kRows >= 4); // two nodes and a set of each: there is room
    (void)add(host, *edge, 0, 1.0 - t);
    (void)add(host, *edge, 1, t);
  }

  /// The mean of the trace over the lattice cell along the side that holds s, continued to s with the mean slope. It is
  /// the trace itself where no node lies inside the cell, exact for linear displacement everywhere, and hands the
  /// forces of a uniform lattice to the nodes exactly as a uniform traction would, whatever the ratio of element to
  /// spacing: over one point per cell, means add up to the integral and slopes to the difference of the ends.
  /// False where the edges do not fill the cell, more than four nodes take part, or a part of it lies across a crack
  /// or seam.
  bool mean_over(const Interval& cell, double s, Host& host) const
  {
    host.clear();
    const double dx = cell.end - cell.begin, offset = (s - 0.5 * (cell.begin + cell.end)) / dx;
    const double tiny = kTiny * dx;
    double filled = 0.0;
    bool parted = false;
    std::array<std::pair<const Edge*, double>, Host::kRows> parts; // with their middles; each brings a row
    std::size_t count = 0;
    const Edge* const last = edges.data() + edges.size();
    for (const Edge* edge = edge_at(cell.begin + tiny); edge != last && edge->begin < cell.end - tiny; ++edge) {
      const double begin = std::max(edge->begin, cell.begin), end = std::min(edge->end, cell.end);
      if (end - begin < tiny) continue;
      if (count == parts.size() || (count && !joined(*parts[count - 1].first, *edge))) return false;
      const auto t = [&](double place) { return (place - edge->begin) / (edge->end - edge->begin); };
      // Mean over the part in this edge, and rise over it; the rises of all parts add up to the slope times dx.
      const double share = (end - begin) / dx, middle = t(0.5 * (begin + end)), rise = t(end) - t(begin);
      if (!add(host, *edge, 0, share * (1.0 - middle) - offset * rise)) return false;
      if (!add(host, *edge, 1, share * middle + offset * rise)) return false;
      parts[count++] = {edge, 0.5 * (begin + end)};
      filled += share;
    }
    if (host.across || std::abs(filled - 1.0) > 1e-6) return false;
    const Edge* beside = edge_beside(s, parted);
    const auto taken = std::span(parts).first(count);
    if (parted && std::ranges::find(taken, beside, [](const auto& part) { return part.first; }) == taken.end())
      return false;
    host.sided = host.sided || parted;
    for (const auto& [cut, ignored] : taken)
      for (const auto& [whole, place] : taken) {
        if (cut->crack < 0 || whole->crack == cut->crack) continue;
        if (cracks->side(cut->crack, point(place)) != cracks->side(cut->crack, from)) return false;
      }
    return true;
  }
};

Surroundings::Surroundings(PatchShape shape, Index band) : shape_(std::move(shape)), band_(band)
{
  for (const geom::StraightSide& line : geom::straight_sides(shape_.active))
    sides_.push_back({line, shape_.line(line.axis, line.at), shape_.line(1 - line.axis, line.from), {}, {}});
  for (std::size_t d = 0; d < 2; ++d) sides_on_[d].resize(static_cast<std::size_t>(shape_.lattice.count[d]) + 1);
  for (std::size_t k = 0; k < sides_.size(); ++k)
    sides_on_[sides_[k].line.axis][static_cast<std::size_t>(sides_[k].line.at)].push_back(k);
  for (std::size_t d = 0; d < 2; ++d) width_[d] = shape_.lattice.count[d] + 2 * band_;
  where_.assign(static_cast<std::size_t>(width_[0]) * static_cast<std::size_t>(width_[1]), 0);
}

bool Surroundings::in_band(const Site<2>& site) const
{
  return site[0] >= -band_ && site[1] >= -band_ && site[0] < shape_.lattice.count[0] + band_ &&
         site[1] < shape_.lattice.count[1] + band_;
}

std::size_t Surroundings::position(const Site<2>& site) const
{
  return static_cast<std::size_t>(site[1] + band_) * static_cast<std::size_t>(width_[0]) +
         static_cast<std::size_t>(site[0] + band_);
}

bool Surroundings::outside(const Site<2>& site) const { return in_band(site) && where_[position(site)] > 0; }

bool Surroundings::exists(const Site<2>& site) const { return shape_.active.has(site) || outside(site); }

bool Surroundings::behind_elements(const Site<2>& site) const
{
  Host host; // nobody asks which
  for (const Side& side : sides_) {
    const auto& [axis, upper, at, from, to] = side.line;
    const Index beyond = upper ? site[axis] - at + 1 : at - site[axis]; // rows outside
    const Index along = std::clamp(site[1 - axis], from, to - 1);
    if (beyond < 1 || beyond > band_ || std::abs(site[1 - axis] - along) > band_) continue;
    const auto d = static_cast<Eigen::Index>(axis);
    const double middle = 0.5 * shape_.lattice.dx, end = shape_.line(1 - axis, to);
    Vector<2> foot;
    foot[d] = side.face;
    foot[1 - d] = std::min(std::max(shape_.lattice.point(site)[1 - d], side.start + middle), end - middle);
    if (!host_on(side, foot, Vector<2>::Zero(), 0, host)) return false;
  }
  return !shape_.active.has(site);
}

const Host& Surroundings::element_host(const Site<2>& site) const
{
  return hosts_[static_cast<std::size_t>(where_[position(site)] - 1)];
}

void Surroundings::find_free_ends()
{
  for (Side& side : sides_)
    for (std::size_t end = 0; end < 2; ++end) {
      const auto& [axis, upper, at, from, to] = side.line;
      Site<2> in{}, out{}; // beyond the end, of the patch and beside it
      in[1 - axis] = out[1 - axis] = end ? to : from - 1;
      in[axis] = upper ? at - 1 : at;
      out[axis] = upper ? at : at - 1;
      side.free_end[end] = !side.edges.empty();
      for (const Site<2>& site : {in, out})
        side.free_end[end] = side.free_end[end] && !exists(site) && !behind_elements(site);
    }
}

/// The cells whose trace a cell along a side is averaged with.
std::array<double, 2> Surroundings::zone_of(const Side& side, double cell, Index zone)
{
  const double cells = side.cells();
  const auto [low, high] = side.free_end;
  if (low && high && cells < 2 * zone) return {0.0, cells};
  if (low && cell < zone) return {0.0, std::min<double>(zone, cells)};
  if (high && cell >= cells - zone) return {std::max(0.0, cells - zone), cells};
  return {cell, cell + 1.0};
}

/// Number of the side both points lie on, -1 for none.
int Surroundings::side_of(const Vector<2>& a, const Vector<2>& b) const
{
  const double near = kOnSide * shape_.lattice.dx;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    const auto d = static_cast<Eigen::Index>(sides_[k].line.axis);
    const double start = sides_[k].start, end = shape_.line(1 - sides_[k].line.axis, sides_[k].line.to);
    const auto on = [&](const Vector<2>& x) {
      return std::abs(x[d] - sides_[k].face) < near && x[1 - d] > start - near && x[1 - d] < end + near;
    };
    if (on(a) && on(b)) return static_cast<int>(k);
  }
  return -1;
}

std::optional<Host> Surroundings::edge_host(const Vector<2>& x, const Vector<2>& inward, Index zone) const
{
  std::optional<Host> host(std::in_place); // worked out in its place
  for (std::size_t d = 0; d < 2; ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    const double line = std::round((x[axis] - shape_.lattice.origin[axis]) / shape_.lattice.dx);
    if (line < 0.0 || line > shape_.lattice.count[d]) continue;
    for (const std::size_t k : sides_on_[d][static_cast<std::size_t>(line)])
      if (host_on(sides_[k], x, inward, zone, *host)) {
        host->side = static_cast<int>(k);
        return host;
      }
  }
  host.reset();
  return host;
}

/// False if x is not on the side, or no elements are there.
bool Surroundings::host_on(const Side& side, const Vector<2>& x, const Vector<2>& inward, Index zone, Host& host) const
{
  const double dx = shape_.lattice.dx, near = kOnSide * dx;
  const auto d = static_cast<Eigen::Index>(side.line.axis);
  if (std::abs(x[d] - side.face) > near || side.edges.empty()) return false;
  const double s = x[1 - d], start = side.start;
  if (s < side.edges.front().begin - near || s > side.edges.back().end + near) return false;
  // A point on the border of two lattice cells counts to the one its bond comes from.
  const double towards = inward[1 - d] > near ? near : inward[1 - d] < -near ? -near : 0.0;
  const Index cells = side.cells();
  const double cell = std::clamp(std::floor((s + towards - start) / dx), 0.0, cells - 1.0);
  const Trace trace{side.edges, cracks_, seams_, x + inward, side.face, 1 - d};
  if (!trace.reaches(s, near, !inward.isZero())) return false;
  const auto over = [&](const std::array<double, 2>& rows, Host& mean) {
    return trace.mean_over({start + rows[0] * dx, start + rows[1] * dx}, s, mean);
  };
  if (zone) {
    // On the border of a zone, bonds that cross each other there share their forces evenly between both sides.
    const double at = (s - start) / dx, border = std::round(at);
    const bool shared = std::abs(at - border) < kOnSide && border > 0.0 && border < cells;
    const auto below = zone_of(side, shared ? border - 1.0 : cell, zone),
               above = shared ? zone_of(side, border, zone) : below;
    if (below[1] - below[0] > 1.0 || above[1] - above[0] > 1.0) {
      Host other;
      if (over(below, host) && over(above, other) && host.mix(other)) return true;
    }
  }
  if (!over({cell, cell + 1.0}, host)) trace.at(s, host);
  return true;
}

Leaving Surroundings::leaving(int side, const Site<2>& site, const std::array<double, 2>& along) const
{
  const geom::StraightSide& line = sides_[static_cast<std::size_t>(side)].line;
  const Index depth = line.upper ? line.at - 1 - site[line.axis] : site[line.axis] - line.at;
  return {side, depth, site[1 - line.axis] - line.from, along[1 - line.axis]};
}

double Surroundings::distance(const Vector<2>& x) const
{
  double nearest = std::numeric_limits<double>::infinity();
  for (const Side& side : sides_)
    for (std::size_t k = 0; k < side.edges.size(); ++k) {
      std::size_t last = k; // edges that meet are one
      while (last + 1 < side.edges.size() && Trace::joined(side.edges[last], side.edges[last + 1])) ++last;
      const auto d = static_cast<Eigen::Index>(side.line.axis);
      const double along = x[1 - d] - std::clamp(x[1 - d], side.edges[k].begin, side.edges[last].end);
      nearest = std::min(nearest, std::hypot(x[d] - side.face, along));
      k = last;
    }
  return nearest;
}

double Surroundings::shortest_edge() const
{
  double shortest = std::numeric_limits<double>::infinity();
  for (const Side& side : sides_)
    for (const Edge& edge : side.edges) shortest = std::min(shortest, edge.end - edge.begin);
  return shortest;
}

std::optional<geom::Box<2>> Surroundings::edges_of_rows(PetscInt first, PetscInt end) const
{
  std::optional<geom::Box<2>> box;
  const auto mine = [&](PetscInt row) { return row >= first && row < end; };
  for (const Side& side : sides_)
    for (const Edge& edge : side.edges) {
      if (!mine(edge.rows[0]) && !mine(edge.rows[1])) continue;
      for (const double s : {edge.begin, edge.end}) {
        Vector<2> x;
        x[static_cast<Eigen::Index>(side.line.axis)] = side.face;
        x[static_cast<Eigen::Index>(1 - side.line.axis)] = s;
        if (!box) box = geom::Box<2>{x, x};
        box->lower = box->lower.cwiseMin(x);
        box->upper = box->upper.cwiseMax(x);
      }
    }
  return box;
}
} // namespace pdx::couple
