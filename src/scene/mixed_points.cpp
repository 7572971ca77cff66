#include "pdx/scene/mixed_points.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/geom/box_cover.hpp"
#include "pdx/geom/clip.hpp"
#include "pdx/mesh/gmsh.hpp"
#include "pdx/scene/body_contact.hpp"
#include "pdx/scene/body_overlap.hpp"
#include "pdx/scene/seeds.hpp"
#include "pdx/scene/settle.hpp"
#include "pdx/scene/thrown_bodies.hpp"

#include "mixed_surface.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pdx::scene {
namespace mixed {
/// Runs a line in a box, for longer than `least` [m]?
bool enters(std::span<const crack::Polyline> lines, const geom::Box<2>& box, double least)
{
  return std::ranges::any_of(lines, [&](const crack::Polyline& line) {
    for (std::size_t p = 1; p < line.size(); ++p)
      if (const auto part = geom::clip<2>(line[p - 1], line[p], box);
          part && (part->leave - part->enter) * (line[p] - line[p - 1]).norm() >= least)
        return true;
    return false;
  });
}

bool same_material(const law::Elastic& a, const law::Elastic& b)
{
  return a.young == b.young && a.poisson == b.poisson && a.density == b.density;
}

/// Of each local vertex, a body it is of.
std::vector<Index> vertex_bodies(const mesh::Mesh& mesh)
{
  std::vector<Index> bodies(static_cast<std::size_t>(mesh.vertices()), 0);
  for (Index c = 0; c < mesh.cells(); ++c)
    for (const Index v : mesh.cell(c)) bodies[static_cast<std::size_t>(v)] = mesh.body(c);
  return bodies;
}

/// Can a cell not become particles?
bool stays(const mesh::Mesh& mesh, const options::SceneOptions& options, const PointPlan<2>& plan, Index cell)
{
  const Index number = mesh.natural_cell(cell) - plan.first_cell;
  if (number < 0) return false;
  const auto& column = plan.cells[static_cast<std::size_t>(number)];
  const mpm::Body<2>& of = plan.bodies[static_cast<std::size_t>(column.body)];
  return of.points_in({column.at[0], column.at[1]}) != mpm::full_mask<2>(of.material.ratio) ||
         !same_material(of.material.elastic, options.elastic);
}

/// Particles are of one material, and take whole cells.
void judge_patches(const mesh::Mesh& mesh, const options::SceneOptions& options, const PointPlan<2>& plan)
{
  constexpr Index none = std::numeric_limits<Index>::max();
  // Cells with points missing, of another material, with a crack.
  std::array<Index, 3> first{none, none, none};
  for (const Index c : mesh.cells(mesh::Use::covered)) {
    const Index cell = mesh.natural_cell(c) - plan.first_cell;
    if (cell < 0) continue;
    const auto& column = plan.cells[static_cast<std::size_t>(cell)];
    const mpm::Body<2>& of = plan.bodies[static_cast<std::size_t>(column.body)];
    if (of.points_in({column.at[0], column.at[1]}) != mpm::full_mask<2>(of.material.ratio))
      first[0] = std::min(first[0], cell);
    if (!same_material(of.material.elastic, options.elastic)) first[1] = std::min(first[1], cell);
  }
  for (const Index c : mesh.cells(mesh::Use::points)) {
    const auto x = mesh.corners(c);
    const Vector<2> rim = 1e-6 * (x[2] - x[0]); // along the border, too: nodes there have no two sides
    if (enters(options.cracks.lines, {x[0] - rim, x[2] + rim}, 1e-3 * (x[2] - x[0]).norm()))
      first[2] = std::min(first[2], mesh.natural_cell(c) - plan.first_cell);
  }
  MPI_Allreduce(MPI_IN_PLACE, first.data(), 3, MPI_INT, MPI_MIN, mesh.comm());
  const auto place = [&](Index cell) {
    const auto& column = plan.cells[static_cast<std::size_t>(cell)];
    const mpm::Body<2>& of = plan.bodies[static_cast<std::size_t>(column.body)];
    return std::pair{of.name, options.frame.text(of.node({column.at[0], column.at[1]}))};
  };
  if (first[0] != none) {
    const auto [name, at] = place(first[0]);
    throw UserError(fmt::format("-pd_patches: the cell of {} at {} is not full of points: particles take whole cells; "
                                "keep patches away from a round or slanted border",
                                name, at));
  }
  if (first[1] != none)
    throw UserError(fmt::format("-pd_patches: particles are of -material_young, _poisson and _density, and {} is of "
                                "another material",
                                place(first[1]).first));
  if (first[2] == none) return;
  const auto [name, at] = place(first[2]);
  throw UserError(fmt::format("-crack_names: a crack runs through material points of {} at {}, which cannot part: give "
                              "-adapt expand -adapt_trigger connection, or -pd_patches around it",
                              name, at));
}
} // namespace mixed

void convert_along_cracks(const PointPlan<2>& plan, options::SceneOptions& options)
{
  const double dx = options.pd.spacing[0];
  for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
    const mpm::Body<2>& of = plan.bodies[b];
    // At the least cells with the crack on their border: it disconnects what is on either side.
    const double reach = std::max(options.layout.triggers.margin - 0.25, 1e-6) * of.cell_size();
    std::vector<geom::Box<2>> boxes;
    for (std::size_t k = 0; k < of.points.size(); ++k) {
      const Site<2> at = of.cell(static_cast<std::int64_t>(k));
      const geom::Box<2> cell{of.node(at), of.node({at[0] + 1, at[1] + 1})};
      const Vector<2> middle = 0.5 * (cell.lower + cell.upper);
      if (of.points[k] != mpm::full_mask<2>(of.material.ratio) || geom::hold(options.pd.patches, middle)) continue;
      const geom::Box<2> near{cell.lower.array() - reach, cell.upper.array() + reach};
      if (mixed::enters(options.cracks.lines, near, 0.0)) boxes.push_back(cell);
    }
    for (const geom::Box<2>& box : geom::joined(std::move(boxes), 1e-6 * dx)) options.pd.patches.push_back(box);
  }
}

std::shared_ptr<const PointPlan<2>> settle_mixed(MPI_Comm comm, options::SceneOptions& options)
{
  mesh::MeshOptions& mesh = options.mesh;
  const double edge = read_elements(comm, mesh);
  const bool elements = std::isfinite(edge);
  auto plan = std::make_shared<PointPlan<2>>(plan_points<2>(options, edge));
  for (const mpm::Body<2>& body : plan->bodies) options.points.regions.push_back(body.around());
  if (elements) options.points.regions.push_back(mesh.box);
  Index first[] = {plan->first_cell, plan->first_node}; // a file's are known where it was read
  MPI_Bcast(first, 2, MPI_INT, 0, comm);
  plan->first_cell = first[0];
  plan->first_node = first[1];
  if (elements && options.points.contact.active) refuse_overlap(comm, *plan, options.frame);
  double corners[] = {plan->mesh.box.lower[0], plan->mesh.box.lower[1], plan->mesh.box.upper[0],
                      plan->mesh.box.upper[1]};
  MPI_Bcast(corners, 4, MPI_DOUBLE, 0, comm);
  plan->mesh.box = {{corners[0], corners[1]}, {corners[2], corners[3]}};
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank) { // a mesh begins on one rank; all know the names of its boundaries
    mesh::CellList names;
    names.boundaries = std::move(plan->mesh.list->boundaries);
    *plan->mesh.list = std::move(names);
  }
  mesh = plan->mesh;
  if (options.pd.seeded) plant_seeds(comm, options);
  if (options.layout.triggers.connection) convert_along_cracks(*plan, options);
  return plan;
}

void deal_cells(const PointPlan<2>& plan, mesh::Mesh& mesh)
{
  for (Index c = 0; c < mesh.cells(); ++c) {
    const Index cell = mesh.natural_cell(c) - plan.first_cell;
    if (cell < 0)
      mesh.set_body(c, plan.elements(), false);
    else
      mesh.set_body(c, plan.cells[static_cast<std::size_t>(cell)].body, true);
  }
}

void add_points(const mesh::Mesh& mesh, const options::SceneOptions& options, const PointPlan<2>& plan,
                Discretisation& d)
{
  d.point_plan = &plan;
  mixed::judge_patches(mesh, options, plan);
  for (Index c = 0; c < mesh.cells(); ++c) d.stays.push_back(mixed::stays(mesh, options, plan, c));
  if (!any_rank(mesh.comm(), !mesh.cells(mesh::Use::points).empty())) return;
  static constexpr std::size_t kAround[] = {0, 1, 3, 2}; // corners of a cell, counter-clockwise, as x fastest
  std::vector<Index> mine;
  for (const Index c : mesh.cells(mesh::Use::points))
    if (c < mesh.owned_cells()) mine.push_back(c);
  std::ranges::sort(mine, {}, [&mesh](Index c) { return mesh.natural_cell(c); });
  std::vector<mpm::PointCell<2>> cells;
  for (const Index c : mine) {
    const auto& column = plan.cells[static_cast<std::size_t>(mesh.natural_cell(c) - plan.first_cell)];
    mpm::PointCell<2> cell{column.body, {}, 0};
    cell.points = plan.bodies[static_cast<std::size_t>(column.body)].points_in({column.at[0], column.at[1]});
    for (std::size_t corner = 0; corner < 4; ++corner)
      cell.rows[corner] = d.node_rows[static_cast<std::size_t>(mesh.cell(c)[kAround[corner]])];
    cells.push_back(cell);
    d.point_cells.push_back({column.body, {column.at[0], column.at[1]}});
  }
  auto term =
      std::make_unique<mpm::PointTerm<2>>(d.system.rows, std::move(cells), plan.materials(), options.points.viscosity);
  term->skip_rest(options.points.skips_rest);
  d.points = term.get();
  d.material_points = term->points();
  MPI_Allreduce(MPI_IN_PLACE, &d.material_points, 1, MPI_INT64_T, MPI_SUM, mesh.comm());
  d.system.terms.push_back(std::move(term));
}

void add_bodies(const mesh::Mesh& mesh, const options::SceneOptions& options, Discretisation& d)
{
  for (const mpm::Body<2>& of : d.point_plan->bodies) d.body_rows.names.push_back(of.name);
  std::vector<couple::ContactBody> bodies = touching_bodies(*d.point_plan);
  if (d.point_plan->first_cell > 0) {
    d.body_rows.names.push_back(options::kMeshBody);
    bodies.push_back({options::kMeshBody, options.elastic.young});
  }
  std::vector<Index>& of_row = d.body_rows.of_row;
  const std::vector<Index> of_vertex = mixed::vertex_bodies(mesh);
  for (const Index v : d.nodes) of_row.push_back(of_vertex[static_cast<std::size_t>(v)]);
  if (d.sets)
    for (const Index v : d.sets->vertices()) of_row.push_back(of_vertex[static_cast<std::size_t>(v)]);
  for (const pd::Particle& p : d.particles) of_row.push_back(mesh.body(p.cell));
  throw_bodies<2>(options.points, *d.point_plan, of_row, d.system);
  const bool by_sites = options.points.contact.by_sites || options.converts() || options.layout.renew_box;
  add_contact<2>(
      options, std::move(bodies), [&] { return surface_points(mesh, d, by_sites); }, d);
}

void keep_books(Discretisation& d)
{
  d.bodies = std::make_unique<BodyBooks<2>>(d.system, d.body_rows, d.touching ? d.touching->books() : nullptr);
}

} // namespace pdx::scene
