#include "pdx/couple/surroundings.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/mesh/locate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace pdx::couple {
namespace {
constexpr double kOnSide = 1e-9; // a point this far from a side, in units of dx, lies on it

/// Side of the box both points lie on: 0 left, 1 right, 2 bottom, 3 top, -1 none.
int side_of(const PatchShape& shape, const Vector<2>& a, const Vector<2>& b)
{
  const double near = 1e-6 * shape.lattice.dx;
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

/// The linear trace of the edges at s itself.
template <class Edges> Host point_trace(const Edges& edges, double s)
{
  auto edge = std::upper_bound(edges.begin(), edges.end(), s, [](double v, const auto& e) { return v < e.begin; });
  if (edge != edges.begin()) --edge;
  const double t = std::clamp((s - edge->begin) / (edge->end - edge->begin), 0.0, 1.0);
  return {{edge->rows[0], edge->rows[1], -1, -1}, {1.0 - t, t, 0.0, 0.0}, 2};
}

/// The mean of the trace over the lattice cell along the side that holds s, continued to s with the mean slope. It is
/// the trace itself where no node lies inside the cell, exact for linear displacement everywhere, and hands the forces
/// of a uniform lattice to the nodes exactly as a uniform traction would, whatever the ratio of element to spacing:
/// over one point per cell, means add up to the integral and slopes to the difference of the ends.
/// Nothing where the edges do not fill the cell or more than four nodes take part.
template <class Edges> std::optional<Host> averaged_trace(const Edges& edges, double s, const Interval& cell)
{
  const double dx = cell.end - cell.begin, offset = (s - 0.5 * (cell.begin + cell.end)) / dx;
  const double tiny = kOnSide * dx;
  Host host;
  double filled = 0.0;
  const auto add = [&](PetscInt row, double weight) {
    std::size_t k = 0;
    while (k < static_cast<std::size_t>(host.count) && host.rows[k] != row) ++k;
    if (k == host.rows.size()) return false;
    if (k == static_cast<std::size_t>(host.count)) host.rows[static_cast<std::size_t>(host.count++)] = row;
    host.weights[k] += weight;
    return true;
  };
  auto edge = std::upper_bound(edges.begin(), edges.end(), cell.begin + tiny,
                               [](double v, const auto& e) { return v < e.begin; });
  if (edge != edges.begin()) --edge;
  for (; edge != edges.end() && edge->begin < cell.end - tiny; ++edge) {
    const double from = std::max(edge->begin, cell.begin), to = std::min(edge->end, cell.end);
    if (to - from < tiny) continue;
    const auto t = [&](double at) { return (at - edge->begin) / (edge->end - edge->begin); };
    // Mean over the part in this edge, and rise over it; the rises of all parts add up to the slope times dx.
    const double share = (to - from) / dx, middle = t(0.5 * (from + to)), rise = t(to) - t(from);
    if (!add(edge->rows[0], share * (1.0 - middle) - offset * rise)) return std::nullopt;
    if (!add(edge->rows[1], share * middle + offset * rise)) return std::nullopt;
    filled += share;
  }
  if (std::abs(filled - 1.0) > 1e-6) return std::nullopt;
  return host;
}
} // namespace

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

std::optional<Host> Surroundings::edge_host(const Vector<2>& x, const Vector<2>& inward) const
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
    const auto host = averaged_trace(sides_[side], s, {start + cell * dx, start + (cell + 1.0) * dx});
    return host ? host : point_trace(sides_[side], s);
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

void Surroundings::find_outside(const mesh::Mesh& mesh, std::span<const Surroundings> patches,
                                std::span<const PetscInt> node_rows, std::vector<OutsideRecord>& found)
{
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    const auto corners = mesh.corners(c);
    const Vector<2> lower = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).cwiseMin(corners[3]);
    const Vector<2> upper = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).cwiseMax(corners[3]);
    for (std::size_t p = 0; p < patches.size(); ++p) {
      if (mesh.patch(c) == static_cast<int>(p)) continue;
      const auto& lattice = patches[p].shape_.lattice;
      const Index band = patches[p].band_;
      Site<2> from{}, to{};
      for (std::size_t d = 0; d < 2; ++d) {
        const auto e = static_cast<Eigen::Index>(d);
        from[d] = std::max(-band, static_cast<Index>(std::floor((lower[e] - lattice.origin[e]) / lattice.dx - 0.51)));
        to[d] = std::min(lattice.count[d] + band - 1,
                         static_cast<Index>(std::ceil((upper[e] - lattice.origin[e]) / lattice.dx - 0.49)));
      }
      std::array<Index, 4> natural{};
      for (std::size_t a = 0; a < 4; ++a) natural[a] = mesh.natural_vertex(mesh.cell(c)[a]);
      for (Site<2> site{0, from[1]}; site[1] <= to[1]; ++site[1])
        for (site[0] = from[0]; site[0] <= to[0]; ++site[0]) {
          if (lattice.contains(site)) continue;
          const Vector<2> x = lattice.point(site);
          if (!mesh::cell_holds(corners, natural, x, 1e-9 * lattice.dx)) continue;
          OutsideRecord record{static_cast<int>(p), site, {}};
          if (mesh.use(c) == mesh::Use::plain) {
            record.host.weights = mesh::bilinear_weights(corners, x);
            record.host.count = 4;
            for (std::size_t a = 0; a < 4; ++a)
              record.host.rows[a] = node_rows[static_cast<std::size_t>(mesh.cell(c)[a])];
          }
          found.push_back(record);
        }
    }
  }
}

void Surroundings::find_edges(const mesh::Mesh& mesh, std::span<const Surroundings> patches,
                              std::span<const PetscInt> node_rows, std::vector<EdgeRecord>& found)
{
  const auto key = [](Index a, Index b) {
    return static_cast<std::int64_t>(std::min(a, b)) << 32 | static_cast<std::int64_t>(std::max(a, b));
  };
  std::unordered_map<std::int64_t, int> behind; // edge -> patch of the neighbour, -1 for elements
  const auto covered = mesh.cells(mesh::Use::covered);
  for (const Index c : covered)
    for (std::size_t a = 0; a < 4; ++a) behind[key(mesh.cell(c)[a], mesh.cell(c)[(a + 1) % 4])] = -2;
  for (Index c = 0; c < mesh.cells(); ++c)
    for (std::size_t a = 0; a < 4 && mesh.use(c) == mesh::Use::plain; ++a)
      if (const auto edge = behind.find(key(mesh.cell(c)[a], mesh.cell(c)[(a + 1) % 4])); edge != behind.end())
        edge->second = -1;
  for (const Index c : covered) {
    if (c >= mesh.owned_cells()) continue;
    for (std::size_t a = 0; a < 4; ++a) {
      Index v = mesh.cell(c)[a], w = mesh.cell(c)[(a + 1) % 4];
      if (behind.at(key(v, w)) != -1) continue;
      const auto p = static_cast<std::size_t>(mesh.patch(c));
      const int side = side_of(patches[p].shape_, mesh.point(v), mesh.point(w));
      if (side < 0) continue;
      const Eigen::Index along = 1 - side / 2;
      if (mesh.point(v)[along] > mesh.point(w)[along]) std::swap(v, w);
      found.push_back({static_cast<int>(p),
                       side,
                       {mesh.point(v)[along],
                        mesh.point(w)[along],
                        {node_rows[static_cast<std::size_t>(v)], node_rows[static_cast<std::size_t>(w)]}}});
    }
  }
}

std::vector<Surroundings> Surroundings::survey(const mesh::Mesh& mesh, std::span<const PatchShape> patches, Index band,
                                               std::span<const PetscInt> node_rows)
{
  std::vector<Surroundings> all;
  for (const PatchShape& shape : patches) all.push_back(Surroundings(shape, band));
  std::vector<OutsideRecord> outside;
  std::vector<EdgeRecord> edges;
  find_outside(mesh, all, node_rows, outside);
  find_edges(mesh, all, node_rows, edges);
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
  return all;
}
} // namespace pdx::couple
