#include "pdx/scene/body_contact.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>

namespace pdx::scene {
template <int Dim> void BodyContact<Dim>::add_energies(std::span<const double> local, post::Energies& mine) const
{
  mine.contact = term_.energy(local);
  mine.friction = books_.dissipated();
}

template <int Dim> std::optional<NamedGrips> BodyContact<Dim>::grips() const
{
  if (term_.law().options().friction == 0.0) return std::nullopt;
  auto all = gather_all(comm_, term_.grips());
  std::ranges::sort(all, {}, [](const auto& grip) { return std::pair(grip.point, grip.body); });
  NamedGrips named;
  for (const couple::NamedGrip<Dim>& grip : all) {
    named.names.insert(named.names.end(), {grip.point, grip.body});
    named.names.insert(named.names.end(), grip.points.begin(), grip.points.end());
    named.numbers.insert(named.numbers.end(), grip.weights.begin(), grip.weights.end());
    named.numbers.push_back(grip.stretch);
  }
  return named;
}

template <int Dim> void BodyContact<Dim>::hold(const NamedGrips& named)
{
  std::vector<couple::NamedGrip<Dim>> all(named.names.size() / (2 + Dim));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::uint64_t* names = named.names.data() + k * (2 + Dim);
    const double* numbers = named.numbers.data() + k * (1 + Dim);
    all[k].point = names[0];
    all[k].body = names[1];
    std::copy_n(names + 2, Dim, all[k].points.begin());
    std::copy_n(numbers, Dim, all[k].weights.begin());
    all[k].stretch = numbers[Dim];
  }
  term_.set_grips(all);
}

template <int Dim>
void add_contact(const options::SceneOptions& options, std::vector<couple::ContactBody> bodies,
                 const std::function<std::vector<couple::SurfacePoint<Dim>>()>& points, Model& model)
{
  const options::ContactOptions& given = options.points.contact;
  if (!given.active || bodies.size() < 2) return;
  couple::ContactOptions rule;
  rule.stiffness = given.stiffness;
  rule.friction = given.friction;
  rule.thickness = options.elastic.thickness;
  rule.frame = options.frame;
  field::System& system = model.system;
  auto term = std::make_unique<couple::ContactTerm<Dim>>(system.rows, points(), std::move(bodies), rule);
  auto books = std::make_unique<couple::ContactStep<Dim>>(*term);
  model.touching = std::make_unique<BodyContact<Dim>>(*term, *books, system.rows.comm);
  system.terms.push_back(std::move(term));
  system.after_step.push_back(std::move(books));
}

template <int Dim> std::vector<couple::ContactBody> touching_bodies(const PointPlan<Dim>& plan)
{
  std::vector<couple::ContactBody> bodies;
  for (const mpm::Body<Dim>& of : plan.bodies) bodies.push_back({of.name, of.material.elastic.young});
  return bodies;
}

namespace body_contact {
/// A place of a cell as its corners carry it.
template <int Dim>
couple::Host carried_by(const mpm::Body<Dim>& body, const Site<Dim>& cell, const mpm::PointCell<Dim>& corners,
                        const Vector<Dim>& x)
{
  const Vector<Dim> at = (x - body.node(cell)) / body.cell_size();
  static_assert(couple::Host::kRows >= 1U << Dim); // there is room for all corners
  couple::Host host;
  for (std::size_t corner = 0; corner < corners.rows.size(); ++corner) {
    double weight = 1.0;
    for (std::size_t d = 0; d < Dim; ++d)
      weight *= corner >> d & 1U ? at[static_cast<Eigen::Index>(d)] : 1.0 - at[static_cast<Eigen::Index>(d)];
    (void)host.add(corners.rows[corner], weight);
  }
  return host;
}

/// Names of the sites of the bodies begin with these.
template <int Dim> std::vector<std::uint64_t> first_names(const PointPlan<Dim>& plan)
{
  std::vector<std::uint64_t> first{0}; // sites of cells of the bodies before each
  for (const mpm::Body<Dim>& of : plan.bodies) first.push_back(first.back() + 64 * of.points.size());
  return first;
}
} // namespace body_contact

template <int Dim>
std::vector<couple::SurfacePoint<Dim>>
surface_points(const PointPlan<Dim>& plan, std::span<const CellOfBody<Dim>> cells, const mpm::PointTerm<Dim>& term,
               const std::function<bool(Index)>& by_sites)
{
  const std::vector<std::uint64_t> first = body_contact::first_names(plan);
  std::vector<couple::SurfacePoint<Dim>> points;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto b = static_cast<std::size_t>(cells[k].body);
    const Site<Dim>& at = cells[k].at;
    const mpm::Body<Dim>& of = plan.bodies[b];
    const std::uint64_t name = first[b] + 64 * static_cast<std::uint64_t>(of.number(at));
    mpm::for_each_point(of.points_in(at), [&](int site) {
      if (!of.uncovered(at, site)) return;
      const Vector<Dim> x = by_sites(cells[k].body) ? of.place(at, site) : of.skin_place(at, site);
      points.push_back({{name + static_cast<std::uint64_t>(site), cells[k].body, x, of.material.spacing},
                        body_contact::carried_by<Dim>(of, at, term.cells()[k], x)});
    });
  }
  return points;
}

template <int Dim>
void add_surface_particle(const PointPlan<Dim>& plan, Index body, const Site<Dim>& site, PetscInt row,
                          std::vector<couple::SurfacePoint<Dim>>& points)
{
  const mpm::Body<Dim>& of = plan.bodies[static_cast<std::size_t>(body)];
  Site<Dim> cell{};
  int in = 0;
  for (std::size_t d = Dim; d-- > 0;) {
    cell[d] = site[d] / of.material.ratio;
    in = in * of.material.ratio + site[d] % of.material.ratio;
  }
  if (!of.uncovered(cell, in)) return;
  const std::uint64_t name = body_contact::first_names(plan)[static_cast<std::size_t>(body)] +
                             64 * static_cast<std::uint64_t>(of.number(cell)) + static_cast<std::uint64_t>(in);
  points.push_back({{name, body, of.place_of(site), of.material.spacing}, couple::Host::of_row(row)});
}

template void add_surface_particle<3>(const PointPlan<3>&, Index, const Site<3>&, PetscInt,
                                      std::vector<couple::SurfacePoint<3>>&);
template class BodyContact<2>;
template class BodyContact<3>;
template void add_contact<2>(const options::SceneOptions&, std::vector<couple::ContactBody>,
                             const std::function<std::vector<couple::SurfacePoint<2>>()>&, Model&);
template void add_contact<3>(const options::SceneOptions&, std::vector<couple::ContactBody>,
                             const std::function<std::vector<couple::SurfacePoint<3>>()>&, Model&);
template std::vector<couple::ContactBody> touching_bodies<2>(const PointPlan<2>&);
template std::vector<couple::ContactBody> touching_bodies<3>(const PointPlan<3>&);
template std::vector<couple::SurfacePoint<2>> surface_points<2>(const PointPlan<2>&, std::span<const CellOfBody<2>>,
                                                                const mpm::PointTerm<2>&,
                                                                const std::function<bool(Index)>&);
template std::vector<couple::SurfacePoint<3>> surface_points<3>(const PointPlan<3>&, std::span<const CellOfBody<3>>,
                                                                const mpm::PointTerm<3>&,
                                                                const std::function<bool(Index)>&);
} // namespace pdx::scene
