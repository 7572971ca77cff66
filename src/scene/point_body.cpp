#include "pdx/scene/point_body.hpp"

#include "pdx/base/fingerprint.hpp"
#include "pdx/scene/body_contact.hpp"
#include "pdx/scene/point_output.hpp"
#include "pdx/scene/thrown_bodies.hpp"

#include <fmt/format.h>

namespace pdx::scene {
namespace {
template <int Dim>
void add_points(const PointPlan<Dim>& plan, const options::PointOptions& options, PointBody<Dim>& body)
{
  std::vector<mpm::PointCell<Dim>> cells;
  for (const auto& cell : std::span(body.grid.cells).first(body.grid.owned))
    cells.push_back({cell.body, cell.rows, plan.bodies[static_cast<std::size_t>(cell.body)].points_in(cell.at)});
  auto term =
      std::make_unique<mpm::PointTerm<Dim>>(body.system.rows, std::move(cells), plan.materials(), options.viscosity);
  term->skip_rest(options.skips_rest);
  body.term = term.get();
  body.system.terms.push_back(std::move(term));
}

} // namespace

template <int Dim> std::string described(const PointPlan<Dim>& plan)
{
  Fingerprint fingerprint;
  for (const mpm::Body<Dim>& body : plan.bodies) {
    fingerprint.add(std::span<const double>(body.corner.data(), Dim));
    fingerprint.add(std::span<const Index>(body.cells));
    for (const std::uint64_t points : body.points) {
      const Index halves[] = {static_cast<Index>(points & 0xffffffffU), static_cast<Index>(points >> 32U)};
      fingerprint.add(std::span<const Index>(halves));
    }
  }
  return fmt::format("{} points {:016x}", plan.count(), fingerprint.value());
}
template <int Dim>
std::unique_ptr<PointBody<Dim>> discretise(const options::SceneOptions& options, const PointPlan<Dim>& plan,
                                           const mesh::Mesh& mesh)
{
  auto body = std::make_unique<PointBody<Dim>>(plan, mesh);
  body->body = mesh.bounds();
  body->material_points = plan.count();
  body->description = described(plan);
  body->node_names = body->grid.names;
  body->system.rows = body->grid.rows;
  for (const Vector<Dim>& x : body->grid.place)
    body->system.coordinates.insert(body->system.coordinates.end(), x.begin(), x.end());
  add_points(plan, options.points, *body);
  throw_bodies<Dim>(options.points, plan, body->grid.body, body->system);
  add_contact<Dim>(
      options, touching_bodies(plan), [&] { return surface_points<Dim>(plan, body->owned_cells(), *body->term); },
      *body);
  apply_conditions(options, *body);
  body->system.bind();
  body->bodies = std::make_unique<BodyBooks<Dim>>(body->system, body->rows_of_bodies(),
                                                  body->touching ? body->touching->books() : nullptr);
  return body;
}

template <int Dim> post::Energies PointBody<Dim>::energies(std::span<const double> local) const
{
  post::Energies mine;
  mine.points = term->energy(local);
  if (touching) touching->add_energies(local, mine);
  return mine;
}

template <int Dim> BodyRows PointBody<Dim>::rows_of_bodies() const
{
  BodyRows rows{{}, grid.body};
  for (const mpm::Body<Dim>& of : plan.bodies) rows.names.push_back(of.name);
  return rows;
}

template <int Dim> std::vector<CellOfBody<Dim>> PointBody<Dim>::owned_cells() const
{
  std::vector<CellOfBody<Dim>> cells;
  for (const auto& cell : std::span(grid.cells).first(grid.owned)) cells.push_back({cell.body, cell.at});
  return cells;
}

template <int Dim>
field::OutputBlock PointBody<Dim>::block(std::span<const double> local, std::span<const double> v) const
{
  int rank = 0;
  MPI_Comm_rank(system.rows.comm, &rank);
  return point_block<Dim>(plan, owned_cells(), *term, local, v, rank, [](const auto&) { return true; });
}

std::vector<field::OutputBlock> PointModel::blocks(Vec u, std::span<const double> velocity) const
{
  std::vector<double> local, all;
  system.halo->gather(u, local);
  system.halo->fetch(velocity, system.rows.dim, all);
  return {block(local, all)};
}

template struct PointBody<2>;
template struct PointBody<3>;
template std::string described<2>(const PointPlan<2>&);
template std::string described<3>(const PointPlan<3>&);
template std::unique_ptr<PointBody<2>> discretise<2>(const options::SceneOptions&, const PointPlan<2>&,
                                                     const mesh::Mesh&);
template std::unique_ptr<PointBody<3>> discretise<3>(const options::SceneOptions&, const PointPlan<3>&,
                                                     const mesh::Mesh&);
} // namespace pdx::scene
