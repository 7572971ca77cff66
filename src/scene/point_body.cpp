#include "pdx/scene/point_body.hpp"

#include "pdx/base/fingerprint.hpp"
#include "pdx/scene/body_contact.hpp"
#include "pdx/scene/point_output.hpp"
#include "pdx/scene/thrown_bodies.hpp"

#include <bit>
#include <fmt/format.h>

namespace pdx::scene {
template <int Dim>
void add_points(const PointPlan<Dim>& plan, const options::PointOptions& options, PointBody<Dim>& body)
{
  std::vector<mpm::PointCell<Dim>> cells;
  for (const auto& cell : std::span(body.grid.cells).first(body.grid.owned))
    cells.push_back({cell.body, cell.rows, plan.bodies[static_cast<std::size_t>(cell.body)].points_in(cell.at)});
  auto term = std::make_unique<mpm::PointTerm<Dim>>(body.model.system.rows, std::move(cells), plan.materials(),
                                                    options.viscosity);
  term->skip_rest(options.skips_rest);
  body.term = term.get();
  body.model.system.terms.push_back(std::move(term));
}

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

template <int Dim> void add_point_shares(const PointPlan<Dim>& plan, const mesh::Mesh& mesh, std::vector<double>& cells)
{
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    const Index number = mesh.natural_cell(c) - plan.first_cell;
    if (number < 0 || mesh.use(c) == mesh::Use::covered) continue;
    const auto& column = plan.cells[static_cast<std::size_t>(number)];
    const mpm::Body<Dim>& of = plan.bodies[static_cast<std::size_t>(column.body)];
    for (const Index layer : plan.cell_layers(column)) {
      Site<Dim> at{};
      at[0] = column.at[0];
      at[1] = column.at[1];
      if constexpr (Dim == 3) at[2] = layer;
      cells[static_cast<std::size_t>(c)] += std::popcount(of.points_in(at));
    }
  }
}

template <int Dim>
std::unique_ptr<Model> discretise(const options::SceneOptions& options, const PointPlan<Dim>& plan,
                                  const mesh::Mesh& mesh)
{
  auto model = std::make_unique<Model>();
  auto owned = std::make_unique<PointBody<Dim>>(plan, mesh, *model);
  PointBody<Dim>& body = *owned;
  model->parts.push_back(std::move(owned));
  model->body = mesh.bounds();
  model->material_points = plan.count();
  field::System& system = model->system;
  system.rows = body.grid.rows;
  for (const Vector<Dim>& x : body.grid.place) system.coordinates.insert(system.coordinates.end(), x.begin(), x.end());
  add_points(plan, options.points, body);
  throw_bodies<Dim>(options.points, plan, body.grid.body, system);
  add_contact<Dim>(
      options, touching_bodies(plan),
      [&] {
        return surface_points<Dim>(plan, body.owned_cells(), *body.term,
                                   [&](Index) { return options.points.contact.by_sites; });
      },
      *model);
  apply_conditions(options, body);
  system.bind();
  model->bodies = std::make_unique<BodyBooks<Dim>>(system, body.rows_of_bodies(),
                                                   model->touching ? model->touching->books() : nullptr);
  return model;
}

template <int Dim> void PointBody<Dim>::add_names(std::vector<field::RowName>& names) const
{
  names.insert(names.end(), grid.names.begin(), grid.names.end());
}

template <int Dim> void PointBody<Dim>::add_numbers(std::vector<PetscInt>& first) const
{
  first.push_back(first.back() + model.system.rows.total);
}

template <int Dim> void PointBody<Dim>::add_energies(std::span<const double> local, post::Energies& mine) const
{
  mine.points += term->energy(local);
}

template <int Dim> void PointBody<Dim>::add_columns(std::vector<io::Column>& columns) const
{
  for (io::Column& column : model.bodies->more_columns()) columns.push_back(std::move(column));
}

template <int Dim>
void PointBody<Dim>::add_row(std::span<const double> local, std::span<const double> velocity,
                             std::vector<double>& row) const
{
  model.bodies->add_more(local, velocity, row);
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
  MPI_Comm_rank(model.system.rows.comm, &rank);
  return point_block<Dim>(plan, owned_cells(), *term, local, v, rank, [](const auto&) { return true; });
}

template <int Dim> void PointBody<Dim>::add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const
{
  std::vector<double> velocity;
  model.system.halo->fetch(now.velocity, Dim, velocity);
  blocks.push_back(block(now.local, velocity));
}

template void add_points<2>(const PointPlan<2>&, const options::PointOptions&, PointBody<2>&);
template void add_points<3>(const PointPlan<3>&, const options::PointOptions&, PointBody<3>&);
template struct PointBody<2>;
template struct PointBody<3>;
template std::string described<2>(const PointPlan<2>&);
template std::string described<3>(const PointPlan<3>&);
template void add_point_shares<2>(const PointPlan<2>&, const mesh::Mesh&, std::vector<double>&);
template void add_point_shares<3>(const PointPlan<3>&, const mesh::Mesh&, std::vector<double>&);
template std::unique_ptr<Model> discretise<2>(const options::SceneOptions&, const PointPlan<2>&, const mesh::Mesh&);
template std::unique_ptr<Model> discretise<3>(const options::SceneOptions&, const PointPlan<3>&, const mesh::Mesh&);
} // namespace pdx::scene
