#include "condition_sides.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/prescriptions.hpp"

#include <cmath>
#include <fmt/format.h>

namespace pdx::scene {
namespace {
constexpr double kOnLine = 1e-6; // of a spacing

template <int Dim> class PointConditions {
public:
  PointConditions(const options::SceneOptions& options, PointBody<Dim>& body) : options_(options), body_(body)
  {
    for (const mpm::Body<Dim>& of : body.plan.bodies) around_.push_back(of.around());
  }

  void apply()
  {
    const auto rows = [&](const options::BoundaryCondition& c, Acts acts) { return rows_of(c, acts); };
    Prescriptions(options_, body_.model)
        .enter(
            rows,
            [&](const options::BoundaryCondition& c, std::span<double> force) {
              if (c.traction) add_traction(c, force);
              if (c.body) add_body_force(c, force);
            },
            [&](const options::BoundaryCondition& c) { return shares_of(c); }, [](Index) { return 0.0; });
  }

private:
  const mpm::Body<Dim>& body_at(Index b) const { return body_.plan.bodies[static_cast<std::size_t>(b)]; }
  bool is_of(const options::BoundaryCondition& c, Index b) const { return c.of.empty() || body_at(b).name == c.of; }
  bool in_box(const options::BoundaryCondition& c, const Vector<Dim>& x, double dx) const
  {
    return !c.box || c.box->contains(x.template head<2>(), kOnLine * dx);
  }
  /// Place of a side along its axis [m].
  double side(const BoxSide& on, Index b) const
  {
    const geom::Box<Dim>& box = around_[static_cast<std::size_t>(b)];
    return (on.high ? box.upper : box.lower)[static_cast<Eigen::Index>(on.axis)];
  }

  [[noreturn]] void refuse_nowhere(const options::BoundaryCondition& c, const char* what, const char* things) const
  {
    const std::string of = c.of.empty() ? "" : fmt::format(" of {}", c.of);
    if (c.on.empty() && !c.box)
      throw UserError(fmt::format("-bc_{}: no {}{} lies anywhere for the {} to act on", c.name, things, of, what));
    throw UserError(fmt::format("-bc_{}_{}: no {}{} lies there for the {} to act on", c.name,
                                c.on.empty() ? "box" : "on", things, of, what));
  }

  std::set<Index> rows_of(const options::BoundaryCondition& c, Acts acts) const
  {
    if (!c.on.empty())
      for (std::size_t b = 0; b < body_.plan.bodies.size(); ++b)
        if (is_of(c, static_cast<Index>(b))) {
          const BoxSide on = point_side(c, Dim);
          const mpm::Body<Dim>& of = body_at(static_cast<Index>(b));
          const double away = side(on, static_cast<Index>(b)) - of.corner[static_cast<Eigen::Index>(on.axis)];
          require_line(c, of.name, away / of.cell_size(), of.cell_size());
        }
    std::set<Index> rows;
    for (std::size_t row = 0; row < body_.grid.place.size(); ++row) {
      const Index b = body_.grid.body[row];
      const Vector<Dim>& x = body_.grid.place[row];
      const double dx = body_at(b).material.spacing;
      if (!is_of(c, b) || !in_box(c, x, dx)) continue;
      if (!c.on.empty()) {
        const BoxSide on = point_side(c, Dim);
        if (std::abs(x[static_cast<Eigen::Index>(on.axis)] - side(on, b)) > kOnLine * dx) continue;
      }
      rows.insert(static_cast<Index>(row));
    }
    if (!any_rank(body_.model.system.rows.comm, !rows.empty())) refuse_nowhere(c, word_of(acts), "node of the grid");
    return rows;
  }

  /// visit(owned row, weight) of the corners of a cell at a place of it.
  template <class Visit>
  void for_each_corner(const typename PointRows<Dim>::Cell& cell, const Vector<Dim>& x, Visit&& visit) const
  {
    const mpm::Body<Dim>& of = body_at(cell.body);
    const Vector<Dim> local = (x - of.node(cell.at)) / of.cell_size();
    const field::Rows& rows = body_.model.system.rows;
    for (std::size_t corner = 0; corner < cell.rows.size(); ++corner) {
      if (!rows.owns(cell.rows[corner])) continue;
      double weight = 1.0;
      for (std::size_t d = 0; d < Dim; ++d) {
        const double at = local[static_cast<Eigen::Index>(d)];
        weight *= corner >> d & 1U ? at : 1.0 - at;
      }
      visit(cell.rows[corner] - rows.first, weight);
    }
  }
  /// Adds a force at a place of a cell to the rows of its corners that are owned.
  void spread(const typename PointRows<Dim>::Cell& cell, const Vector<Dim>& x, const Vector<3>& load,
              std::span<double> force) const
  {
    for_each_corner(cell, x, [&](Index row, double weight) {
      for (std::size_t d = 0; d < Dim; ++d)
        force[Dim * static_cast<std::size_t>(row) + d] += weight * load[static_cast<Eigen::Index>(d)];
    });
  }

  /// Points by body and box.
  void add_body_force(const options::BoundaryCondition& c, std::span<double> force) const
  {
    bool any = false;
    for (const auto& cell : body_.grid.cells) {
      if (!is_of(c, cell.body)) continue;
      const mpm::Body<Dim>& of = body_at(cell.body);
      mpm::for_each_point(of.points_in(cell.at), [&](int site) {
        const Vector<Dim> x = of.place(cell.at, site);
        if (!in_box(c, x, of.material.spacing)) return;
        any = true;
        spread(cell, x, volume(of) * *c.body, force);
      });
    }
    if (!any_rank(body_.model.system.rows.comm, any)) refuse_nowhere(c, "body force", "point");
  }

  /// Faces of sites on a side of a body, where no other site lies beyond them: visit(cell, middle, area).
  template <class Visit> void for_each_face(const options::BoundaryCondition& c, const char* what, Visit&& visit) const
  {
    const BoxSide on = point_side(c, Dim);
    const auto axis = static_cast<Eigen::Index>(on.axis);
    bool any = false;
    for (const auto& cell : body_.grid.cells) {
      if (!is_of(c, cell.body)) continue;
      const mpm::Body<Dim>& of = body_at(cell.body);
      const double dx = of.material.spacing;
      mpm::for_each_point(of.points_in(cell.at), [&](int site) {
        Vector<Dim> face = of.place(cell.at, site);
        face[axis] += on.high ? 0.5 * dx : -0.5 * dx;
        if (std::abs(face[axis] - side(on, cell.body)) > kOnLine * dx || !in_box(c, face, dx)) return;
        any = true;
        visit(cell, face, volume(of) / dx);
      });
    }
    if (!any_rank(body_.model.system.rows.comm, any)) refuse_nowhere(c, what, "point");
  }

  void add_traction(const options::BoundaryCondition& c, std::span<double> force) const
  {
    for_each_face(c, "traction", [&](const typename PointRows<Dim>::Cell& cell, const Vector<Dim>& face, double area) {
      spread(cell, face, area * *c.traction, force);
    });
  }

  std::vector<SideShare> shares_of(const options::BoundaryCondition& c) const
  {
    std::vector<SideShare> shares;
    const Vector<3> normal = Vector<3>::Unit(static_cast<Eigen::Index>(point_side(c, Dim).axis));
    for_each_face(c, "springs", [&](const typename PointRows<Dim>::Cell& cell, const Vector<Dim>& face, double area) {
      for_each_corner(cell, face, [&](Index row, double weight) {
        if (weight > 0.0) shares.push_back({row, weight * area, normal});
      });
    });
    return shares;
  }

  double volume(const mpm::Body<Dim>& of) const ///< of a point [m^3]
  {
    return std::pow(of.material.spacing, Dim) * (Dim == 2 ? of.material.elastic.thickness : 1.0);
  }

  const options::SceneOptions& options_;
  PointBody<Dim>& body_;
  std::vector<geom::Box<Dim>> around_; // of bodies
};
} // namespace

template <int Dim> void apply_conditions(const options::SceneOptions& options, PointBody<Dim>& body)
{
  PointConditions<Dim>(options, body).apply();
}
template void apply_conditions<2>(const options::SceneOptions&, PointBody<2>&);
template void apply_conditions<3>(const options::SceneOptions&, PointBody<3>&);
} // namespace pdx::scene
