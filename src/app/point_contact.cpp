#include "pdx/app/contact_grips.hpp"
#include "pdx/app/point_body.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/couple/contact_books.hpp"

#include <algorithm>
#include <utility>

namespace pdx::app {
namespace {
/// A place of a cell as its corners carry it.
template <int Dim>
couple::Host carried_by(const mpm::Body<Dim>& body, const typename PointRows<Dim>::Cell& cell, const Vector<Dim>& x)
{
  const Vector<Dim> at = (x - body.node(cell.at)) / body.cell_size();
  couple::Host host;
  for (std::size_t corner = 0; corner < cell.rows.size(); ++corner) {
    double weight = 1.0;
    for (std::size_t d = 0; d < Dim; ++d)
      weight *= corner >> d & 1U ? at[static_cast<Eigen::Index>(d)] : 1.0 - at[static_cast<Eigen::Index>(d)];
    host.add(cell.rows[corner], weight);
  }
  return host;
}

/// Of the cells this rank owns.
template <int Dim> std::vector<couple::SurfacePoint<Dim>> surface_points(const PointBody<Dim>& body)
{
  std::vector<std::uint64_t> first{0}; // sites of cells of the bodies before each
  for (const mpm::Body<Dim>& of : body.plan.bodies) first.push_back(first.back() + 64 * of.points.size());
  std::vector<couple::SurfacePoint<Dim>> points;
  for (const auto& cell : std::span(body.grid.cells).first(body.grid.owned)) {
    const auto b = static_cast<std::size_t>(cell.body);
    const mpm::Body<Dim>& of = body.plan.bodies[b];
    const std::uint64_t name = first[b] + 64 * static_cast<std::uint64_t>(of.number(cell.at));
    mpm::for_each_point(of.points_in(cell.at), [&](int site) {
      if (!of.at_surface(cell.at, site)) return;
      const Vector<Dim> x = of.place(cell.at, site);
      points.push_back(
          {{name + static_cast<std::uint64_t>(site), cell.body, x, of.material.spacing}, carried_by<Dim>(of, cell, x)});
    });
  }
  return points;
}
} // namespace

template <int Dim> void add_contact(const SceneOptions& options, PointBody<Dim>& body)
{
  const ContactOptions& given = options.points.contact;
  if (!given.active || body.plan.bodies.size() < 2) return;
  couple::ContactOptions rule;
  rule.stiffness = given.stiffness;
  rule.friction = given.friction;
  rule.thickness = options.elastic.thickness;
  std::vector<couple::ContactBody> bodies;
  for (const mpm::Body<Dim>& of : body.plan.bodies) bodies.push_back({of.name, of.material.elastic.young});
  auto term =
      std::make_unique<couple::ContactTerm<Dim>>(body.system.rows, surface_points(body), std::move(bodies), rule);
  auto books = std::make_unique<couple::ContactStep<Dim>>(*term);
  body.contact = term.get();
  body.books = books.get();
  body.system.terms.push_back(std::move(term));
  body.system.after_step.push_back(std::move(books));
}

template <int Dim> std::optional<NamedGrips> PointBody<Dim>::grips() const
{
  return named_grips<Dim>(system.rows.comm, contact);
}

template <int Dim> void PointBody<Dim>::set_grips(const NamedGrips& named) const { hold_grips<Dim>(contact, named); }

template std::optional<NamedGrips> PointBody<2>::grips() const;
template std::optional<NamedGrips> PointBody<3>::grips() const;
template void PointBody<2>::set_grips(const NamedGrips&) const;
template void PointBody<3>::set_grips(const NamedGrips&) const;
template void add_contact<2>(const SceneOptions&, PointBody<2>&);
template void add_contact<3>(const SceneOptions&, PointBody<3>&);
} // namespace pdx::app
