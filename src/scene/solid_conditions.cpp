#include "condition_sides.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/scene/prescriptions.hpp"
#include "pdx/scene/solid.hpp"

#include <fmt/format.h>

namespace pdx::scene {
namespace {
BoxSide side_of(const options::BoundaryCondition& c)
{
  if (const auto side = box_side(c.on, 3)) return *side;
  throw UserError(
      fmt::format("-bc_{}_on is {}: a solid has left, right, bottom, top, back (z = 0) and front", c.name, c.on));
}

class SolidConditions {
public:
  SolidConditions(const options::SceneOptions& options, const geom::Lattice<3>& lattice, Model& solid)
      : options_(options), lattice_(lattice), solid_(solid)
  {}

  void apply()
  {
    const auto rows = [&](const options::BoundaryCondition& c, Acts acts) { return rows_of(c, word_of(acts)); };
    Prescriptions(options_, solid_)
        .enter(
            rows,
            [&](const options::BoundaryCondition& c, std::span<double> force) {
              const double dx = lattice_.dx;
              if (c.traction) add(rows_of(c, "traction"), dx * dx / c.rows * *c.traction, force);
              if (c.body) add(rows_of(c, "body force"), dx * dx * dx * *c.body, force);
            },
            [&](const options::BoundaryCondition& c) {
              std::vector<SideShare> shares;
              const Vector<3> normal = Vector<3>::Unit(static_cast<Eigen::Index>(side_of(c).axis));
              for (const Index row : rows_of(c, "springs"))
                shares.push_back({row, lattice_.dx * lattice_.dx / c.rows, normal});
              return shares;
            },
            [&](Index) { return 0.5 * lattice_.dx; });
  }

private:
  /// The box is seen in the plane; under a side, where that side is.
  bool inside(const options::BoundaryCondition& c, const Site<3>& site) const
  {
    if (!c.box) return true;
    Vector<3> x = lattice_.point(site);
    if (!c.on.empty()) {
      const auto [axis, high] = side_of(c);
      const auto a = static_cast<Eigen::Index>(axis);
      x[a] = lattice_.origin[a] + (high ? lattice_.count[axis] * lattice_.dx : 0.0);
    }
    return c.box->contains(x.head<2>(), 1e-6 * lattice_.dx);
  }

  bool under(const options::BoundaryCondition& c, const Site<3>& site) const
  {
    if (c.on.empty()) return true;
    const auto [axis, high] = side_of(c);
    return (high ? lattice_.count[axis] - 1 - site[axis] : site[axis]) < c.rows;
  }

  std::set<Index> rows_of(const options::BoundaryCondition& c, const char* what) const
  {
    std::set<Index> rows;
    if (!c.on.empty()) (void)side_of(c); // refused on ranks without particles too
    for (std::size_t k = 0; k < solid_.particles.size(); ++k) {
      const Site<3> site = lattice_.site(solid_.particles[k].site);
      if (under(c, site) && inside(c, site)) rows.insert(static_cast<Index>(k));
    }
    if (!any_rank(solid_.system.rows.comm, !rows.empty()))
      throw UserError(
          fmt::format("-bc_{}_{}: no particle lies there for the {} to act on", c.name, c.box ? "box" : "on", what));
    return rows;
  }

  static void add(const std::set<Index>& rows, const Vector<3>& each, std::span<double> force)
  {
    for (const Index row : rows)
      for (Index a = 0; a < 3; ++a) force[static_cast<std::size_t>(3 * row + a)] += each[a];
  }

  const options::SceneOptions& options_;
  const geom::Lattice<3>& lattice_;
  Model& solid_;
};
} // namespace

void apply_conditions(const options::SceneOptions& options, const geom::Lattice<3>& lattice, Model& solid)
{
  SolidConditions(options, lattice, solid).apply();
}
} // namespace pdx::scene
