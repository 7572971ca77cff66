#include "pdx/scene/apply_conditions.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/fem/loads.hpp"
#include "pdx/scene/prescriptions.hpp"
#include "pdx/xfem/edge_parts.hpp"
#include "pdx/xfem/halves.hpp"
#include "pdx/xfem/loads.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace pdx::scene {
namespace {
/// Boundary edge of a covered cell, known to all ranks.
struct CoveredEdge {
  int patch;
  std::array<double, 2> a, b;
};

class Conditions {
public:
  Conditions(const mesh::Mesh& mesh, const options::SceneOptions& options, const PatchPlan& plan, Discretisation& d)
      : mesh_(mesh), options_(options), plan_(plan), d_(d)
  {}

  void apply()
  {
    Prescriptions(options_, d_)
        .enter([&](const options::BoundaryCondition& c, Acts acts) { return rows_of(c, acts); },
               [&](const options::BoundaryCondition& c, std::span<double> force) {
                 load_ = force;
                 if (c.traction) pull(c);
                 if (c.body) weigh(c);
                 if (c.force) push(c);
               },
               [&](const options::BoundaryCondition& c) { return shares_of(c); },
               [&](Index row) { return half_size(row); });
    note_side_held();
  }

private:
  /// Particles in the place of elements or points would be held as the nodes were where a box holds all of them, and
  /// not where the nodes lie on a side, or at the border of a box.
  void note_side_held()
  {
    d_.side_held.assign(2 * d_.nodes.size(), 0);
    for (const options::BoundaryCondition& c : options_.conditions) {
      if (!c.holds()) continue;
      std::vector<std::uint8_t> outer(static_cast<std::size_t>(mesh_.vertices()), c.on.empty() && c.box ? 0 : 1);
      for (Index cell = 0; cell < mesh_.cells() && c.on.empty() && c.box; ++cell)
        if (!std::ranges::all_of(mesh_.corners(cell), [&](const Vector<2>& x) { return inside(c, x); }))
          for (const Index v : mesh_.cell(cell)) outer[static_cast<std::size_t>(v)] = 1;
      for (const Index row : rows_of(c, Acts::held)) {
        const auto k = static_cast<std::size_t>(row);
        if (k >= d_.nodes.size()) break; // they ascend
        for (std::size_t a = 0; a < 2; ++a)
          if (outer[static_cast<std::size_t>(d_.nodes[k])] && c.holds(a)) d_.side_held[2 * k + a] = 1;
      }
    }
  }

  /// A side of a body of points is one of edges only where lines of its grid are.
  void require_sides(const options::BoundaryCondition& c) const
  {
    if (!d_.point_plan || !mesh_.boundary(c.on)) return;
    for (const mpm::Body<2>& of : d_.point_plan->bodies) {
      const auto* edges = mesh_.boundary(of.name + ":" + c.on);
      if (!edges || (!c.of.empty() && c.of != of.name) || any_rank(mesh_.comm(), !edges->empty())) continue;
      throw UserError(
          fmt::format("-bc_{0}_on is {1}: that side of {2} lies within cells of its grid, {3:g} m wide: make its "
                      "length a whole number of cells, or choose by -bc_{0}_box",
                      c.name, c.on, of.name, of.cell_size()));
    }
  }

  const std::vector<mesh::BoundaryEdge>& side_of(const options::BoundaryCondition& c) const
  {
    require_sides(c);
    const auto* edges = mesh_.boundary(c.of.empty() ? c.on : c.of + ":" + c.on);
    if (!edges)
      throw UserError(fmt::format("-bc_{}_on is {}: the mesh has no such boundary; it has {}", c.name, c.on,
                                  fmt::join(mesh_.boundary_names(), ", ")));
    return *edges;
  }

  /// Those that lie in its box wholly.
  std::vector<mesh::BoundaryEdge> edges_of(const options::BoundaryCondition& c) const
  {
    std::vector<mesh::BoundaryEdge> kept;
    for (const mesh::BoundaryEdge& e : side_of(c))
      if (!c.box || (inside(c, mesh_.point(e.vertices[0])) && inside(c, mesh_.point(e.vertices[1])))) kept.push_back(e);
    return kept;
  }

  /// Is row k, of all that are owned, of the body that a condition is for?
  bool is_of(const options::BoundaryCondition& c, std::size_t k) const
  {
    return c.of.empty() || d_.body_rows.names.at(static_cast<std::size_t>(d_.body_rows.of_row[k])) == c.of;
  }
  bool is_of(const options::BoundaryCondition& c, const pd::Particle& p) const
  {
    return c.of.empty() || d_.body_rows.names.at(static_cast<std::size_t>(mesh_.body(p.cell))) == c.of;
  }

  bool inside(const options::BoundaryCondition& c, const Vector<2>& x) const
  {
    return !c.box || c.box->contains(x, near());
  }

  /// Places as near as this are one [m].
  double near() const { return std::max(1e-9 * mesh_.bounds().size().norm(), 2.0 * options_.frame.step()); }

  std::vector<CoveredEdge> covered_edges(const std::vector<mesh::BoundaryEdge>& edges) const
  {
    std::vector<CoveredEdge> mine;
    for (const mesh::BoundaryEdge& e : edges) {
      if (mesh_.use(e.cell) != mesh::Use::covered || e.cell >= mesh_.owned_cells()) continue;
      const Vector<2>&a = mesh_.point(e.vertices[0]), &b = mesh_.point(e.vertices[1]);
      mine.push_back({mesh_.patch(e.cell), {a[0], a[1]}, {b[0], b[1]}});
    }
    return gather_all(mesh_.comm(), mine);
  }

  /// Rows of owned particles in the first `count` rows under an edge; every particle under exactly one edge.
  std::vector<Index> particles_under(const CoveredEdge& edge, int count) const
  {
    const auto& shape = plan_.shapes[static_cast<std::size_t>(edge.patch)];
    const auto& lattice = shape.lattice;
    const int along = std::abs(edge.b[0] - edge.a[0]) > std::abs(edge.b[1] - edge.a[1]) ? 0 : 1;
    const auto s = static_cast<std::size_t>(along), n = 1 - s;
    const auto first = [&](double x, std::size_t d) {
      return static_cast<Index>(
          std::ceil((x - lattice.origin[static_cast<Eigen::Index>(d)]) / lattice.dx - 0.5 - 1e-6));
    };
    const Index line = first(edge.a[n], n);
    std::vector<Index> rows;
    Site<2> site{};
    site[s] = first(std::min(edge.a[s], edge.b[s]), s);
    site[n] = line - 1;
    const bool low = !shape.active.has(site); // the patch lies above the edge
    const auto named = [](const pd::Particle& p) { return std::pair{p.patch, p.site}; };
    for (Index k = 0; k < std::min<Index>(count, lattice.count[n]); ++k)
      for (site[s] = first(std::min(edge.a[s], edge.b[s]), s); site[s] < first(std::max(edge.a[s], edge.b[s]), s);
           ++site[s]) {
        site[n] = low ? line + k : line - 1 - k;
        if (!shape.active.has(site)) continue;
        const std::pair wanted{Index{edge.patch}, static_cast<Index>(shape.active.place(site))};
        const auto at = std::ranges::lower_bound(d_.particles, wanted, {}, named); // by patch and site
        if (at != d_.particles.end() && named(*at) == wanted)
          rows.push_back(d_.system.rows.first_particle() + static_cast<Index>(at - d_.particles.begin()));
      }
    return rows;
  }

  /// What the condition's boundary and box select; without either, everything.
  std::set<Index> rows_of(const options::BoundaryCondition& c, Acts acts) const
  {
    std::set<Index> rows;
    if (!c.on.empty() && !c.layer) {
      for (const mesh::BoundaryEdge& e : side_of(c))
        for (const Index v : e.vertices)
          if (inside(c, mesh_.point(v))) add_node(v, c, acts, rows, &e);
      for (const CoveredEdge& e : covered_edges(edges_of(c)))
        for (const Index row : particles_under(e, c.rows)) rows.insert(row);
    } else {
      for (std::size_t k = 0; k < d_.nodes.size(); ++k)
        if (c.on.empty() && is_of(c, k)) add_node(d_.nodes[k], c, acts, rows);
      for (std::size_t k = 0; k < d_.particles.size(); ++k)
        if (is_of(c, d_.particles[k]) && (c.layer ? in_layer(c, d_.particles[k].x) : inside(c, d_.particles[k].x)))
          rows.insert(d_.system.rows.first_particle() + static_cast<Index>(k));
    }
    if (!any_rank(mesh_.comm(), !rows.empty()))
      throw UserError(fmt::format("-bc_{}_{}: no node and no particle lies there{}", c.name, c.box ? "box" : "on",
                                  !c.box || c.on.empty() ? ""
                                                         : fmt::format(": it chooses nodes of {}, and of particles "
                                                                       "those under whole element edges of it",
                                                                       c.on)));
    return rows;
  }

  /// The halves of a node that lie in the condition's box; of an edge, those that have some of it. A far half can be
  /// thrown by itself, but held only with the near one, from which its row counts.
  void add_node(Index v, const options::BoundaryCondition& c, Acts acts, std::set<Index>& rows,
                const mesh::BoundaryEdge* of = nullptr) const
  {
    const PetscInt row = d_.node_rows[static_cast<std::size_t>(v)];
    if (v >= mesh_.owned_vertices() || row < 0) return;
    const std::span<const xfem::EnrichedSet> sets = d_.sets ? d_.sets->of(v) : std::span<const xfem::EnrichedSet>();
    bool near = !sets.empty() || inside(c, mesh_.point(v));
    for (const xfem::EnrichedSet& set : sets) near = near && inside(c, halves_of(mesh_, *d_.sets, v, set).near);
    if (near) rows.insert(row - d_.system.rows.first);
    for (const xfem::EnrichedSet& set : sets) {
      const std::optional<Vector<2>> far =
          of ? xfem::far_half_on(mesh_, *d_.sets, *of, v, set) : halves_of(mesh_, *d_.sets, v, set).far;
      if (far && (near || acts == Acts::thrown) && inside(c, *far)) rows.insert(set.row - d_.system.rows.first);
    }
  }

  /// Of elements by their middle, of particles by their place [m].
  double thickness_at(const Vector<2>& x) const
  {
    return options_.regions ? options_.regions->elastic(options_.regions->at(x)).thickness : options_.elastic.thickness;
  }
  double thickness(Index cell) const { return thickness_at(mesh_.centroid(cell)); }
  const Vector<2>& place_of(Index row) const ///< of a particle
  {
    return d_.particles[static_cast<std::size_t>(row - d_.system.rows.first_particle())].x;
  }

  /// How far a particle goes beyond its place; nodes are where the body ends, and sets are nowhere [m].
  double half_size(Index row) const
  {
    if (row < d_.system.rows.nodes) return 0.0;
    if (row < d_.system.rows.first_particle()) return -1.0;
    const pd::Particle& p = d_.particles[static_cast<std::size_t>(row - d_.system.rows.first_particle())];
    return 0.5 * plan_.shapes[static_cast<std::size_t>(p.patch)].lattice.dx;
  }

  bool in_layer(const options::BoundaryCondition& c, const Vector<2>& x) const
  {
    if (!inside(c, x)) return false;
    if (c.on == "left") return x[0] < plan_.body.lower[0];
    if (c.on == "right") return x[0] > plan_.body.upper[0];
    return c.on == "bottom" ? x[1] < plan_.body.lower[1] : x[1] > plan_.body.upper[1];
  }

  /// Half an edge to each of its nodes, or its particles; edges of nodes that a crack enriches have no springs.
  std::vector<SideShare> shares_of(const options::BoundaryCondition& c) const
  {
    const auto edges = edges_of(c);
    const auto normal = [](const Vector<2>& a, const Vector<2>& b) -> Vector<3> {
      const Vector<2> along = (b - a).normalized();
      return {along[1], -along[0], 0.0};
    };
    std::vector<SideShare> shares;
    bool any = false, cracked = false;
    for (const mesh::BoundaryEdge& e : edges) {
      if (mesh_.use(e.cell) == mesh::Use::covered) continue;
      const Vector<2>&a = mesh_.point(e.vertices[0]), &b = mesh_.point(e.vertices[1]);
      any = true;
      for (const Index v : e.vertices) {
        const PetscInt row = d_.node_rows[static_cast<std::size_t>(v)];
        cracked = cracked || (d_.sets && !d_.sets->of(v).empty());
        if (d_.system.rows.owns(row))
          shares.push_back({row - d_.system.rows.first, 0.5 * (b - a).norm() * thickness(e.cell), normal(a, b)});
      }
    }
    for (const CoveredEdge& e : covered_edges(edges)) {
      const Vector<2> a(e.a[0], e.a[1]), b(e.b[0], e.b[1]);
      const double dx = plan_.shapes[static_cast<std::size_t>(e.patch)].lattice.dx;
      any = true;
      for (const Index row : particles_under(e, c.rows))
        shares.push_back({row, dx * thickness_at(place_of(row)) / c.rows, normal(a, b)});
    }
    if (any_rank(mesh_.comm(), cracked))
      throw UserError(fmt::format("-bc_{}_spring: a crack cuts elements at that side, whose halves springs do not tell "
                                  "apart: leave them out by _box",
                                  c.name));
    if (!any_rank(mesh_.comm(), any))
      throw UserError(
          fmt::format("-bc_{}_{}: no edge lies there for the springs to act on", c.name, c.box ? "box" : "on"));
    return shares;
  }

  void pull(const options::BoundaryCondition& c)
  {
    const auto edges = edges_of(c);
    const Vector<2> traction = c.traction->head<2>();
    fem::add_traction(mesh_, edges, traction, fem::Thickness([this](Index cell) { return thickness(cell); }), target());
    if (d_.sets)
      xfem::add_traction(mesh_, *d_.sets, edges, traction,
                         fem::Thickness([this](Index cell) { return thickness(cell); }), target());
    double length = 0.0;
    for (const mesh::BoundaryEdge& e : edges)
      if (mesh_.use(e.cell) != mesh::Use::covered) length += 1.0;
    for (const CoveredEdge& e : covered_edges(edges)) {
      const double dx = plan_.shapes[static_cast<std::size_t>(e.patch)].lattice.dx;
      for (const Index row : particles_under(e, c.rows)) add(row, dx * thickness_at(place_of(row)) / c.rows * traction);
      length += 1.0;
    }
    if (!any_rank(mesh_.comm(), length > 0.0))
      throw UserError(
          fmt::format("-bc_{}_{}: no edge lies there for the traction to act on", c.name, c.box ? "box" : "on"));
  }

  void weigh(const options::BoundaryCondition& c)
  {
    bool reached = false;
    const auto density = [&](const Vector<2>& x) {
      reached = reached || inside(c, x);
      return inside(c, x) ? Vector<2>(c.body->head<2>()) : Vector<2>(0.0, 0.0);
    };
    if (c.of.empty() || c.of == options::kMeshBody) {
      fem::add_body_force(mesh_, density, fem::Thickness([this](Index cell) { return thickness(cell); }), target());
      if (d_.sets)
        xfem::add_body_force(mesh_, *d_.sets, density, fem::Thickness([this](Index cell) { return thickness(cell); }),
                             target());
    }
    if (d_.point_plan) weigh_points(c, reached);
    for (std::size_t k = 0; k < d_.particles.size(); ++k) {
      if (!is_of(c, d_.particles[k])) continue;
      const double dx = plan_.shapes[static_cast<std::size_t>(d_.particles[k].patch)].lattice.dx;
      add(d_.system.rows.first_particle() + static_cast<Index>(k),
          dx * dx * thickness_at(d_.particles[k].x) * density(d_.particles[k].x));
    }
    if (!any_rank(mesh_.comm(), reached))
      throw UserError(fmt::format("-bc_{}_box: nothing lies there for the body force to act on", c.name));
  }

  /// Material points, each by its volume.
  void weigh_points(const options::BoundaryCondition& c, bool& reached)
  {
    const PointPlan<2>& plan = *d_.point_plan;
    for (const Index cell : mesh_.cells(mesh::Use::points)) {
      const auto& column = plan.cells[static_cast<std::size_t>(mesh_.natural_cell(cell) - plan.first_cell)];
      const mpm::Body<2>& of = plan.bodies[static_cast<std::size_t>(column.body)];
      if (!c.of.empty() && of.name != c.of) continue;
      const Site<2> at{column.at[0], column.at[1]};
      mpm::for_each_point(of.points_in(at), [&](int site) {
        const Vector<2> x = of.place(at, site);
        if (!inside(c, x)) return;
        reached = true;
        const couple::Host host = couple::host_in_cell({mesh_, d_.node_rows, d_.sets.get()}, cell, x);
        const Vector<2> force = mpm::point_volume<2>(of.material) * c.body->head<2>();
        for (std::size_t k = 0; k < static_cast<std::size_t>(host.count); ++k)
          if (d_.system.rows.owns(host.rows[k])) add(host.rows[k] - d_.system.rows.first, host.weights[k] * force);
      });
    }
  }

  void push(const options::BoundaryCondition& c)
  {
    if (!mesh_.bounds().contains(*c.at, near()))
      throw UserError(fmt::format("-bc_{}_at is {}: lies outside the mesh", c.name, options_.frame.text(*c.at)));
    std::vector<std::pair<Vector<2>, Index>> places;
    for (std::size_t k = 0; k < d_.nodes.size(); ++k)
      places.emplace_back(mesh_.point(d_.nodes[k]), static_cast<Index>(k));
    for (std::size_t k = 0; k < d_.particles.size(); ++k)
      places.emplace_back(d_.particles[k].x, d_.system.rows.first_particle() + static_cast<Index>(k));
    double nearest = std::numeric_limits<double>::max();
    for (const auto& place : places) nearest = std::min(nearest, (place.first - *c.at).norm());
    MPI_Allreduce(MPI_IN_PLACE, &nearest, 1, MPI_DOUBLE, MPI_MIN, mesh_.comm());

    // Places at the same distance share the force: which rank has them, and in what order, must not matter.
    const double within = nearest + near();
    std::erase_if(places, [&](const auto& place) { return (place.first - *c.at).norm() > within; });
    auto count = static_cast<Index>(places.size());
    MPI_Allreduce(MPI_IN_PLACE, &count, 1, MPI_INT, MPI_SUM, mesh_.comm());
    for (const auto& place : places) add(place.second, Vector<2>(c.force->head<2>() / count));
  }

  fem::NodalForces target() { return {d_.node_rows, d_.system.rows, load_}; }
  void add(Index row, const Vector<2>& force)
  {
    for (Index a = 0; a < 2; ++a) load_[static_cast<std::size_t>(2 * row + a)] += force[a];
  }

  const mesh::Mesh& mesh_;
  const options::SceneOptions& options_;
  const PatchPlan& plan_;
  Discretisation& d_;
  std::span<double> load_; // of one condition [N]
};
} // namespace

void apply_conditions(const mesh::Mesh& mesh, const options::SceneOptions& options, const PatchPlan& plan,
                      Discretisation& d)
{
  Conditions(mesh, options, plan, d).apply();
}
} // namespace pdx::scene
