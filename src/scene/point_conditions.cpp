#include "condition_sides.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/prescriptions.hpp"

#include <cmath>
#include <fmt/format.h>

namespace pdx::scene {
namespace point_places {
constexpr double kOnLine = 1e-6; // of a spacing

/// Which places of the bodies of a plan a condition chooses.
template <int Dim> class PointPlaces {
public:
  explicit PointPlaces(const PointPlan<Dim>& plan) : plan_(plan)
  {
    for (const mpm::Body<Dim>& of : plan.bodies) around_.push_back(of.around());
  }
  const mpm::Body<Dim>& body_at(Index b) const { return plan_.bodies[static_cast<std::size_t>(b)]; }
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
  /// Is a place of a body chosen that is no further from a side than `depth`, if one is named?
  bool chosen(const options::BoundaryCondition& c, Index b, const Vector<Dim>& x, double depth) const
  {
    if (!is_of(c, b) || !in_box(c, x, body_at(b).material.spacing)) return false;
    if (c.on.empty()) return true;
    const BoxSide on = point_side(c, Dim);
    return std::abs(x[static_cast<Eigen::Index>(on.axis)] - side(on, b)) <= depth;
  }
  bool node_chosen(const options::BoundaryCondition& c, Index b, const Vector<Dim>& x) const
  {
    return chosen(c, b, x, kOnLine * body_at(b).material.spacing);
  }

private:
  const PointPlan<Dim>& plan_;
  std::vector<geom::Box<Dim>> around_; // of bodies
};
} // namespace point_places

namespace {
using point_places::kOnLine;
using point_places::PointPlaces;

template <int Dim> class PointConditions {
public:
  PointConditions(const options::SceneOptions& options, PointBody<Dim>& body)
      : options_(options), body_(body), places_(body.plan)
  {}

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
            [&](const options::BoundaryCondition& c) { return shares_of(c); },
            [&](Index row) { return half_size(row); });
  }

private:
  const mpm::Body<Dim>& body_at(Index b) const { return places_.body_at(b); }
  bool is_of(const options::BoundaryCondition& c, Index b) const { return places_.is_of(c, b); }
  bool in_box(const options::BoundaryCondition& c, const Vector<Dim>& x, double dx) const
  {
    return places_.in_box(c, x, dx);
  }
  double side(const BoxSide& on, Index b) const { return places_.side(on, b); }

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
    const auto nodes = static_cast<std::size_t>(body_.grid.rows.nodes);
    for (std::size_t row = 0; row < body_.grid.place.size(); ++row) {
      const Index b = body_.grid.body[row];
      const Vector<Dim>& x = body_.grid.place[row];
      const bool chosen = row < nodes
                              ? places_.node_chosen(c, b, x) // particles beside a side lie half a spacing inside
                              : places_.chosen(c, b, x, body_at(b).material.spacing);
      if (chosen) rows.insert(static_cast<Index>(row));
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
    for_each_corner(cell, x,
                    [&](Index row, double weight) { push(static_cast<std::size_t>(row), weight * load, force); });
  }
  /// How far a particle goes beyond its place; nodes of the grid are where the body ends, but for those out of its
  /// shape that next to nothing hangs on [m].
  double half_size(Index row)
  {
    constexpr double kCorner = 0.8 / (1 << Dim); // less than the corner of a full body bears
    if (row < body_.grid.rows.first_particle()) {
      if (borne_.empty()) find_borne();
      return borne_[static_cast<std::size_t>(row)] < kCorner ? -1.0 : 0.0;
    }
    return 0.5 * body_at(body_.grid.body[static_cast<std::size_t>(row)]).material.spacing;
  }

  /// The part of a cell's points that nodes bear.
  void find_borne()
  {
    borne_.assign(static_cast<std::size_t>(body_.grid.rows.first_particle()), 0.0);
    for (const Cell& cell : body_.grid.cells) {
      const mpm::Body<Dim>& of = body_at(cell.body);
      const double sites = std::pow(of.cell_size() / of.material.spacing, Dim);
      mpm::for_each_point(of.points_in(cell.at), [&](int site) {
        for_each_corner(cell, of.place(cell.at, site),
                        [&](Index row, double weight) { borne_[static_cast<std::size_t>(row)] += weight / sites; });
      });
    }
  }

  /// Calls visit(row, body, place) for the particles of the bodies that a condition is for.
  template <class Visit> void for_each_particle(const options::BoundaryCondition& c, Visit&& visit) const
  {
    for (auto row = static_cast<std::size_t>(body_.grid.rows.first_particle()); row < body_.grid.place.size(); ++row)
      if (const Index b = body_.grid.body[row]; is_of(c, b)) visit(row, body_at(b), body_.grid.place[row]);
  }
  static void push(std::size_t row, const Vector<3>& load, std::span<double> force)
  {
    for (std::size_t d = 0; d < Dim; ++d) force[Dim * row + d] += load[static_cast<Eigen::Index>(d)];
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
    for_each_particle(c, [&](std::size_t row, const mpm::Body<Dim>& of, const Vector<Dim>& x) {
      if (!in_box(c, x, of.material.spacing)) return;
      any = true;
      push(row, volume(of) * *c.body, force);
    });
    if (!any_rank(body_.model.system.rows.comm, any)) refuse_nowhere(c, "body force", "point");
  }

  /// Faces of sites on a side of a body, where no other site lies beyond them.
  /// @param visit (cell, middle, area) of points   @param visit_particle (row, area)
  template <class Visit, class VisitParticle>
  void for_each_face(const options::BoundaryCondition& c, const char* what, Visit&& visit,
                     VisitParticle&& visit_particle) const
  {
    const BoxSide on = point_side(c, Dim);
    const auto axis = static_cast<Eigen::Index>(on.axis);
    bool any = false;
    const auto is_face = [&](const mpm::Body<Dim>& of, Index body, Vector<Dim>& face) {
      const double dx = of.material.spacing;
      face[axis] += on.high ? 0.5 * dx : -0.5 * dx;
      const bool found = std::abs(face[axis] - side(on, body)) <= kOnLine * dx && in_box(c, face, dx);
      any = any || found;
      return found;
    };
    for (const auto& cell : body_.grid.cells) {
      if (!is_of(c, cell.body)) continue;
      const mpm::Body<Dim>& of = body_at(cell.body);
      mpm::for_each_point(of.points_in(cell.at), [&](int site) {
        Vector<Dim> face = of.place(cell.at, site);
        if (is_face(of, cell.body, face)) visit(cell, face, volume(of) / of.material.spacing);
      });
    }
    for_each_particle(c, [&](std::size_t row, const mpm::Body<Dim>& of, Vector<Dim> face) {
      if (is_face(of, body_.grid.body[row], face)) visit_particle(row, volume(of) / of.material.spacing);
    });
    if (!any_rank(body_.model.system.rows.comm, any)) refuse_nowhere(c, what, "point");
  }

  using Cell = typename PointRows<Dim>::Cell;
  void add_traction(const options::BoundaryCondition& c, std::span<double> force) const
  {
    for_each_face(
        c, "traction",
        [&](const Cell& cell, const Vector<Dim>& face, double area) { spread(cell, face, area * *c.traction, force); },
        [&](std::size_t row, double area) { push(row, area * *c.traction, force); });
  }

  std::vector<SideShare> shares_of(const options::BoundaryCondition& c) const
  {
    std::vector<SideShare> shares;
    const Vector<3> normal = Vector<3>::Unit(static_cast<Eigen::Index>(point_side(c, Dim).axis));
    for_each_face(
        c, "springs",
        [&](const Cell& cell, const Vector<Dim>& face, double area) {
          for_each_corner(cell, face, [&](Index row, double weight) {
            if (weight > 0.0) shares.push_back({row, weight * area, normal});
          });
        },
        [&](std::size_t row, double area) {
          shares.push_back({static_cast<Index>(row), area, normal});
        });
    return shares;
  }

  double volume(const mpm::Body<Dim>& of) const ///< of a point [m^3]
  {
    return std::pow(of.material.spacing, Dim) * (Dim == 2 ? of.material.elastic.thickness : 1.0);
  }

  const options::SceneOptions& options_;
  PointBody<Dim>& body_;
  PointPlaces<Dim> places_;
  std::vector<double> borne_; // by nodes, once a pin asks
};
} // namespace

template <int Dim> void apply_conditions(const options::SceneOptions& options, PointBody<Dim>& body)
{
  PointConditions<Dim>(options, body).apply();
}

template <int Dim>
std::vector<std::vector<std::uint8_t>> side_held_cells(const options::SceneOptions& options, const PointPlan<Dim>& plan)
{
  const point_places::PointPlaces<Dim> places(plan);
  std::vector<std::vector<std::uint8_t>> held;
  for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
    const mpm::Body<Dim>& of = plan.bodies[b];
    held.emplace_back(of.points.size(), std::uint8_t{0});
    const auto each_corner = [&](const Site<Dim>& cell, auto&& visit) {
      for (unsigned corner = 0; corner < 1U << Dim; ++corner) {
        Site<Dim> node = cell;
        for (std::size_t d = 0; d < Dim; ++d) node[d] += static_cast<Index>(corner >> d & 1U);
        visit(node);
      }
    };
    for (const options::BoundaryCondition& c : options.conditions) {
      if (!c.holds() || !places.is_of(c, static_cast<Index>(b))) continue;
      const auto holds = [&](const Site<Dim>& node) {
        return places.node_chosen(c, static_cast<Index>(b), of.node(node));
      };
      const bool whole = c.on.empty() && c.box; // a cell all of whose nodes are in the box is held as particles are
      std::set<Site<Dim>> outer;                // nodes that are held for another reason
      for (std::size_t k = 0; k < of.points.size(); ++k) {
        if (of.points[k] == 0) continue;
        bool all = true;
        each_corner(of.cell(static_cast<std::int64_t>(k)), [&](const Site<Dim>& node) { all = all && holds(node); });
        if (whole && all) continue;
        each_corner(of.cell(static_cast<std::int64_t>(k)), [&](const Site<Dim>& node) {
          if (holds(node)) outer.insert(node);
        });
      }
      if (outer.empty()) continue;
      for (std::size_t k = 0; k < of.points.size(); ++k)
        each_corner(of.cell(static_cast<std::int64_t>(k)), [&](const Site<Dim>& node) {
          if (outer.contains(node)) held.back()[k] = 1;
        });
    }
  }
  return held;
}
template std::vector<std::vector<std::uint8_t>> side_held_cells<3>(const options::SceneOptions&, const PointPlan<3>&);
template void apply_conditions<2>(const options::SceneOptions&, PointBody<2>&);
template void apply_conditions<3>(const options::SceneOptions&, PointBody<3>&);
} // namespace pdx::scene
