#include "pdx/couple/surroundings.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/mesh/locate.hpp"
#include "pdx/mesh/sites.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace pdx::couple {
namespace {
constexpr double kOnSide = 1e-5; // a point this far from a side, in units of dx, lies on it: sides fit to 1e-6
constexpr double kTiny = 1e-7;   // a part of an edge as short as this, in units of dx, is none

/// Side of the box both points lie on: 0 left, 1 right, 2 bottom, 3 top, -1 none.
int side_of(const PatchShape& shape, const Vector<2>& a, const Vector<2>& b)
{
  const double near = kOnSide * shape.lattice.dx;
  for (int d = 0; d < 2; ++d)
    for (int upper = 0; upper < 2; ++upper) {
      const double face = upper ? shape.box.upper[d] : shape.box.lower[d];
      if (std::abs(a[d] - face) < near && std::abs(b[d] - face) < near) return 2 * d + upper;
    }
  return -1;
}

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
  Host at(double s) const
  {
    Host host;
    const Edge* edge = edge_beside(s, host.sided);
    const double t = std::clamp((s - edge->begin) / (edge->end - edge->begin), 0.0, 1.0);
    (void)add(host, *edge, 0, 1.0 - t);
    (void)add(host, *edge, 1, t);
    return host;
  }

  /// The mean of the trace over the lattice cell along the side that holds s, continued to s with the mean slope. It is
  /// the trace itself where no node lies inside the cell, exact for linear displacement everywhere, and hands the
  /// forces of a uniform lattice to the nodes exactly as a uniform traction would, whatever the ratio of element to
  /// spacing: over one point per cell, means add up to the integral and slopes to the difference of the ends.
  /// Nothing where the edges do not fill the cell, more than four nodes take part, or a part of it lies across a crack
  /// or seam.
  std::optional<Host> mean_over(const Interval& cell, double s) const
  {
    const double dx = cell.end - cell.begin, offset = (s - 0.5 * (cell.begin + cell.end)) / dx;
    const double tiny = kTiny * dx;
    Host host;
    double filled = 0.0;
    bool parted = false;
    std::vector<std::pair<const Edge*, double>> parts; // with their middles
    const Edge* const last = edges.data() + edges.size();
    for (const Edge* edge = edge_at(cell.begin + tiny); edge != last && edge->begin < cell.end - tiny; ++edge) {
      const double begin = std::max(edge->begin, cell.begin), end = std::min(edge->end, cell.end);
      if (end - begin < tiny) continue;
      if (!parts.empty() && !joined(*parts.back().first, *edge)) return std::nullopt;
      const auto t = [&](double place) { return (place - edge->begin) / (edge->end - edge->begin); };
      // Mean over the part in this edge, and rise over it; the rises of all parts add up to the slope times dx.
      const double share = (end - begin) / dx, middle = t(0.5 * (begin + end)), rise = t(end) - t(begin);
      if (!add(host, *edge, 0, share * (1.0 - middle) - offset * rise)) return std::nullopt;
      if (!add(host, *edge, 1, share * middle + offset * rise)) return std::nullopt;
      parts.emplace_back(edge, 0.5 * (begin + end));
      filled += share;
    }
    if (host.across || std::abs(filled - 1.0) > 1e-6) return std::nullopt;
    const Edge* beside = edge_beside(s, parted);
    if (parted && std::ranges::find(parts, beside, [](const auto& part) { return part.first; }) == parts.end())
      return std::nullopt;
    host.sided = host.sided || parted;
    for (const auto& [cut, ignored] : parts)
      for (const auto& [whole, place] : parts) {
        if (cut->crack < 0 || whole->crack == cut->crack) continue;
        if (cracks->side(cut->crack, point(place)) != cracks->side(cut->crack, from)) return std::nullopt;
      }
    return host;
  }
};

Surroundings::Surroundings(PatchShape shape, Index band) : shape_(std::move(shape)), band_(band)
{
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

bool Surroundings::exists(const Site<2>& site) const { return shape_.lattice.contains(site) || outside(site); }

bool Surroundings::behind_elements(const Site<2>& site) const
{
  const Vector<2> x = shape_.lattice.point(site);
  const Vector<2> margin = Vector<2>::Constant(0.5 * shape_.lattice.dx);
  for (Eigen::Index d = 0; d < 2; ++d) {
    if (x[d] > shape_.box.lower[d] && x[d] < shape_.box.upper[d]) continue;
    Vector<2> foot = x.cwiseMax(shape_.box.lower + margin).cwiseMin(shape_.box.upper - margin);
    foot[d] = x[d] < shape_.box.lower[d] ? shape_.box.lower[d] : shape_.box.upper[d];
    if (!edge_host(foot, Vector<2>::Zero())) return false;
  }
  return !shape_.lattice.contains(site);
}

const Host& Surroundings::element_host(const Site<2>& site) const
{
  return hosts_[static_cast<std::size_t>(where_[position(site)] - 1)];
}

void Surroundings::find_free_ends()
{
  const auto& count = shape_.lattice.count;
  for (std::size_t side = 0; side < 4; ++side)
    for (std::size_t end = 0; end < 2; ++end) {
      const std::size_t d = side / 2;
      Site<2> in{}, out{}; // beyond the end, of the patch and beside it
      in[1 - d] = out[1 - d] = end ? count[1 - d] : -1;
      in[d] = side % 2 ? count[d] - 1 : 0;
      out[d] = side % 2 ? count[d] : -1;
      free_end_[side][end] = !sides_[side].empty();
      for (const Site<2>& site : {in, out})
        free_end_[side][end] = free_end_[side][end] && !exists(site) && !behind_elements(site);
    }
}

/// The cells whose trace a cell along a side is averaged with.
std::array<double, 2> Surroundings::zone_of(std::size_t side, double cell, Index zone) const
{
  const double cells = shape_.lattice.count[1 - side / 2];
  const auto [low, high] = free_end_[side];
  if (low && high && cells < 2 * zone) return {0.0, cells};
  if (low && cell < zone) return {0.0, std::min<double>(zone, cells)};
  if (high && cell >= cells - zone) return {std::max(0.0, cells - zone), cells};
  return {cell, cell + 1.0};
}

std::optional<Host> Surroundings::edge_host(const Vector<2>& x, const Vector<2>& inward, Index zone) const
{
  const double dx = shape_.lattice.dx, near = kOnSide * dx;
  for (std::size_t side = 0; side < 4; ++side) {
    const auto d = static_cast<Eigen::Index>(side / 2);
    const double face = side % 2 ? shape_.box.upper[d] : shape_.box.lower[d];
    if (std::abs(x[d] - face) > near || sides_[side].empty()) continue;
    const double s = x[1 - d], start = shape_.box.lower[1 - d];
    if (s < sides_[side].front().begin - near || s > sides_[side].back().end + near) continue;
    // A point on the border of two lattice cells counts to the one its bond comes from.
    const double towards = inward[1 - d] > near ? near : inward[1 - d] < -near ? -near : 0.0;
    const auto cells = shape_.lattice.count[static_cast<std::size_t>(1 - d)];
    const double cell = std::clamp(std::floor((s + towards - start) / dx), 0.0, cells - 1.0);
    const Trace trace{sides_[side], cracks_, seams_, x + inward, face, 1 - d};
    const auto over = [&](const std::array<double, 2>& rows) {
      return trace.mean_over({start + rows[0] * dx, start + rows[1] * dx}, s);
    };
    if (zone) {
      // On the border of a zone, bonds that cross each other there share their forces evenly between both sides.
      const double at = (s - start) / dx, border = std::round(at);
      const bool shared = std::abs(at - border) < kOnSide && border > 0.0 && border < cells;
      const auto below = zone_of(side, shared ? border - 1.0 : cell, zone),
                 above = shared ? zone_of(side, border, zone) : below;
      if (below[1] - below[0] > 1.0 || above[1] - above[0] > 1.0) {
        std::optional<Host> host = over(below);
        const std::optional<Host> other = over(above);
        if (host && other && host->mix(*other)) return host;
      }
    }
    const auto host = trace.mean_over({start + cell * dx, start + (cell + 1.0) * dx}, s);
    return host ? host : trace.at(s);
  }
  return std::nullopt;
}

double Surroundings::shortest_edge() const
{
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto& side : sides_)
    for (const Edge& edge : side) shortest = std::min(shortest, edge.end - edge.begin);
  return shortest;
}

std::optional<geom::Box<2>> Surroundings::edges_of_rows(PetscInt first, PetscInt end) const
{
  std::optional<geom::Box<2>> box;
  for (std::size_t side = 0; side < 4; ++side) {
    const auto d = static_cast<Eigen::Index>(side / 2);
    for (const Edge& edge : sides_[side]) {
      const auto mine = [&](PetscInt row) { return row >= first && row < end; };
      if (!mine(edge.rows[0]) && !mine(edge.rows[1])) continue;
      for (const double s : {edge.begin, edge.end}) {
        Vector<2> x;
        x[d] = side % 2 ? shape_.box.upper[d] : shape_.box.lower[d];
        x[1 - d] = s;
        if (!box) box = geom::Box<2>{x, x};
        box->lower = box->lower.cwiseMin(x);
        box->upper = box->upper.cwiseMax(x);
      }
    }
  }
  return box;
}

Host Surroundings::host_in_cell(const Scene& scene, Index cell, const Vector<2>& x)
{
  const auto weights = mesh::bilinear_weights(scene.mesh.corners(cell), x);
  const xfem::CutElement* cut = scene.sets ? scene.sets->cut(cell) : nullptr;
  Host host;
  host.across = cut && scene.sets->side_in(*cut, x) != xfem::side_of(scene.sets->cracks().side(cut->crack, x));
  for (std::size_t a = 0; a < 4; ++a) {
    const PetscInt node = scene.node_rows[static_cast<std::size_t>(scene.mesh.cell(cell)[a])];
    (void)host.add(node, weights[a]);
    if (!cut) continue;
    const double factor = xfem::set_factor(*cut, a, scene.sets->side_in(*cut, x));
    if (factor != 0.0) (void)host.cross(node, cut->sets[a], weights[a], factor);
  }
  return host;
}

void Surroundings::find_outside(const Scene& scene, std::span<const Surroundings> patches,
                                std::vector<OutsideRecord>& found)
{
  const mesh::Mesh& mesh = scene.mesh;
  for (Index c = 0; c < mesh.owned_cells(); ++c)
    for (std::size_t p = 0; p < patches.size(); ++p) {
      if (mesh.patch(c) == static_cast<int>(p)) continue;
      const auto& lattice = patches[p].shape_.lattice;
      mesh::for_each_site(mesh, c, lattice, patches[p].band_, [&](const Site<2>& site, const Vector<2>& x) {
        if (lattice.contains(site)) return;
        const bool element = mesh.use(c) != mesh::Use::covered;
        found.push_back({static_cast<int>(p), site, element ? host_in_cell(scene, c, x) : Host{}});
      });
    }
}

Surroundings::Edge Surroundings::edge_of(const Scene& scene, Index behind, std::array<Index, 2> vertices,
                                         Eigen::Index along)
{
  const mesh::Mesh& mesh = scene.mesh;
  if (mesh.point(vertices[0])[along] > mesh.point(vertices[1])[along]) std::swap(vertices[0], vertices[1]);
  Edge edge{};
  edge.begin = mesh.point(vertices[0])[along];
  edge.end = mesh.point(vertices[1])[along];
  edge.crack = -1;
  const xfem::CutElement* cut = scene.sets ? scene.sets->cut(behind) : nullptr;
  if (cut) {
    edge.crack = cut->crack;
    edge.snapped = cut->snapped ? (*cut->snapped == xfem::Side::plus ? 1 : -1) : 0;
  }
  for (std::size_t end = 0; end < 2; ++end) {
    edge.rows[end] = scene.node_rows[static_cast<std::size_t>(vertices[end])];
    edge.sets[end] = -1;
    for (std::size_t a = 0; cut && a < 4; ++a)
      if (mesh.cell(behind)[a] == vertices[end]) {
        edge.sets[end] = cut->sets[a];
        edge.node_side[end] = cut->element.side[a];
      }
  }
  return edge;
}

void Surroundings::find_edges(const Scene& scene, std::span<const Surroundings> patches, std::vector<EdgeRecord>& found)
{
  const mesh::Mesh& mesh = scene.mesh;
  const auto key = [](Index a, Index b) {
    return static_cast<std::int64_t>(std::min(a, b)) << 32 | static_cast<std::int64_t>(std::max(a, b));
  };
  std::unordered_map<std::int64_t, Index> behind; // edge -> element on the other side, -1 for none
  const auto covered = mesh.cells(mesh::Use::covered);
  for (const Index c : covered)
    for (std::size_t a = 0; a < 4; ++a) behind[key(mesh.cell(c)[a], mesh.cell(c)[(a + 1) % 4])] = -1;
  for (Index c = 0; c < mesh.cells(); ++c)
    for (std::size_t a = 0; a < 4 && mesh.use(c) != mesh::Use::covered; ++a)
      if (const auto edge = behind.find(key(mesh.cell(c)[a], mesh.cell(c)[(a + 1) % 4])); edge != behind.end())
        edge->second = c;
  for (const Index c : covered) {
    if (c >= mesh.owned_cells()) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      const Index v = mesh.cell(c)[a], w = mesh.cell(c)[(a + 1) % 4], element = behind.at(key(v, w));
      if (element < 0) continue;
      const auto p = static_cast<std::size_t>(mesh.patch(c));
      const int side = side_of(patches[p].shape_, mesh.point(v), mesh.point(w));
      if (side >= 0) found.push_back({static_cast<int>(p), side, edge_of(scene, element, {v, w}, 1 - side / 2)});
    }
  }
}

std::vector<Surroundings> Surroundings::survey(const mesh::Mesh& mesh, std::span<const PatchShape> patches, Index band,
                                               std::span<const PetscInt> node_rows, const xfem::EnrichedSets* sets,
                                               const crack::CrackSet* seams)
{
  std::vector<Surroundings> all;
  for (const PatchShape& shape : patches) all.push_back(Surroundings(shape, band));
  for (Surroundings& around : all) {
    around.cracks_ = sets ? &sets->cracks() : nullptr;
    around.seams_ = seams;
  }
  std::vector<OutsideRecord> outside;
  std::vector<EdgeRecord> edges;
  const Scene scene{mesh, node_rows, sets};
  find_outside(scene, all, outside);
  find_edges(scene, all, edges);
  for (const OutsideRecord& record : gather_all(mesh.comm(), outside)) {
    Surroundings& around = all[static_cast<std::size_t>(record.patch)];
    around.hosts_.push_back(record.host);
    around.where_[around.position(record.site)] = static_cast<Index>(around.hosts_.size());
  }
  for (const EdgeRecord& record : gather_all(mesh.comm(), edges))
    all[static_cast<std::size_t>(record.patch)].sides_[static_cast<std::size_t>(record.side)].push_back(record.edge);
  for (Surroundings& around : all)
    for (auto& side : around.sides_)
      std::sort(side.begin(), side.end(), [](const Edge& a, const Edge& b) { return a.begin < b.begin; });
  for (Surroundings& around : all) around.find_free_ends();
  return all;
}
} // namespace pdx::couple
