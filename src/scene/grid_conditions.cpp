#include "condition_sides.hpp"
#include "grid_body.hpp"
#include "pdx/base/gather.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::scene {
namespace {
constexpr double kNearSide = 1e-6; // of a cell

template <int Dim> bool acts_on(const options::BoundaryCondition& c, const mpm::Body<Dim>& of)
{
  return c.of.empty() || of.name == c.of;
}

/// Nodes that a condition holds: by box, by the sides of bodies, or all where neither is said.
template <int Dim>
std::vector<geom::Box<Dim>> held_places(const options::BoundaryCondition& c, const GridBody<Dim>& body)
{
  constexpr double far = 1e30;
  const double h = body.motion->rule().side;
  geom::Box<Dim> whole{Vector<Dim>::Constant(-far), Vector<Dim>::Constant(far)};
  if (c.box) {
    whole.lower.template head<2>() = c.box->lower;
    whole.upper.template head<2>() = c.box->upper;
  }
  if (c.on.empty()) return {whole};
  const auto [on, high] = point_side(c, Dim);
  const auto axis = static_cast<Eigen::Index>(on);
  std::vector<geom::Box<Dim>> places;
  for (const mpm::Body<Dim>& of : body.plan.bodies) {
    if (!acts_on(c, of)) continue;
    const geom::Box<Dim> around = of.around();
    const double at = (high ? around.upper : around.lower)[axis];
    require_line(c, of.name, (at - body.origin[axis]) / h, h);
    places.push_back(whole);
    places.back().lower[axis] = places.back().upper[axis] = at;
  }
  return places;
}

/// Holds nodes in all places that a condition chooses, and books their force.
/// @param along of the force: its parts become columns
template <int Dim>
void add_holds(const options::BoundaryCondition& c, mpm::GridHold<Dim> hold, const Vector<Dim>& along,
               GridBody<Dim>& body)
{
  for (const geom::Box<Dim>& box : held_places(c, body)) {
    hold.box = box;
    body.motion->hold(hold);
    for (int d = 0; d < Dim; ++d)
      if (along[d] != 0.0)
        body.holds.push_back({fmt::format("reaction_{}_{}", c.name, kAxes[d]), body.held_places, along[d]});
    ++body.held_places;
  }
}

template <int Dim> void hold(const options::BoundaryCondition& c, GridBody<Dim>& body)
{
  const field::History history = c.history.value_or(field::History());
  if (c.roller) {
    const Vector<Dim> along = c.roller->template head<Dim>();
    return add_holds<Dim>(c, {{}, 0, {}, along, {}, {}}, along, body);
  }
  for (int d = 0; d < Dim; ++d) {
    const auto axis = static_cast<std::size_t>(d);
    if (!c.turn && !c.displacement[axis] && !c.velocity[axis]) continue;
    const bool moves = c.velocity[axis].has_value();
    const double value = c.turn ? *c.turn : moves ? *c.velocity[axis] : *c.displacement[axis];
    if (!moves && value != 0.0 && history.value(0.0) != 0.0)
      throw UserError(fmt::format("-bc_{0}_{2} is {1:g} at once: nodes of a grid that is made anew only have "
                                  "velocities; give {3}a history that begins at 0",
                                  c.name, value, c.turn ? "turn" : "displacement",
                                  c.turn ? "" : fmt::format("-bc_{}_velocity, or ", c.name)));
    const auto rate = [=](double time) { return value * (moves ? history.value(time) : history.rate(time)); };
    mpm::GridHold<Dim> hold{{}, d, {}, {}, {}, {}};
    (c.turn ? hold.spin : hold.velocity) = rate;
    if (c.turn) hold.centre = *c.centre;
    add_holds<Dim>(c, hold, Vector<Dim>::Unit(d), body);
  }
}

template <int Dim> void push(const options::BoundaryCondition& c, GridBody<Dim>& body)
{
  for (std::size_t b = 0; b < body.materials.size(); ++b)
    if (acts_on(c, body.plan.bodies[b]))
      body.pushes.push_back(
          {b, mpm::point_volume<Dim>(body.materials[b]) * *c.body, c.history.value_or(field::History())});
}
} // namespace

template <int Dim> void apply_conditions(const options::SceneOptions& options, GridBody<Dim>& body)
{
  for (const options::BoundaryCondition& c : options.conditions) {
    if (c.holds()) hold(c, body);
    if (c.body) push(c, body);
  }
}

template <int Dim> void throw_points(const options::SceneOptions& options, GridBody<Dim>& body)
{
  std::vector<double>& v = body.model.system.initial_velocity;
  for (const options::BoundaryCondition& c : options.conditions) {
    if (!c.initial_velocity) continue;
    bool any = false;
    for (std::size_t row = 0; row < body.grid.place.size(); ++row) {
      const mpm::Body<Dim>& of = body.plan.bodies[static_cast<std::size_t>(body.grid.body[row])];
      const Vector<Dim>& x = body.grid.place[row];
      if (!acts_on(c, of) || (c.box && !c.box->contains(x.template head<2>(), kNearSide * of.material.spacing)))
        continue;
      any = true;
      for (std::size_t d = 0; d < Dim; ++d) v[Dim * row + d] = (*c.initial_velocity)[static_cast<Eigen::Index>(d)];
    }
    if (!any_rank(body.model.system.rows.comm, any))
      throw UserError(fmt::format("-bc_{}_box: no point lies there for the initial velocity to act on", c.name));
  }
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void apply_conditions<Dim>(const options::SceneOptions&, GridBody<Dim>&);                                   \
  template void throw_points<Dim>(const options::SceneOptions&, GridBody<Dim>&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::scene
