#include "pdx/scene/space_plan.hpp"

#include "pdx/couple/face_trace.hpp"
#include "pdx/scene/patches.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::scene {
namespace space_plan {
constexpr double kOnLine = 1e-6; // of a cell

std::string text(const geom::Frame& frame, const Vector<3>& inside)
{
  const Vector<3> x = frame.given<3>(inside);
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x[0], x[1], x[2]);
}

/// The numbers of cells [first, second) of a body that a box is; none where it lies elsewhere or cuts through cells.
std::optional<std::pair<Site<3>, Site<3>>> cells_in(const mpm::Body<3>& of, const geom::Box<3>& box)
{
  std::pair<Site<3>, Site<3>> cells;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto a = static_cast<Eigen::Index>(d);
    const double low = (box.lower[a] - of.corner[a]) / of.cell_size(),
                 high = (box.upper[a] - of.corner[a]) / of.cell_size();
    if (std::abs(low - std::round(low)) > kOnLine || std::abs(high - std::round(high)) > kOnLine) return std::nullopt;
    if (low < -kOnLine || high > of.cells[d] + kOnLine) return std::nullopt;
    cells.first[d] = static_cast<Index>(std::lround(low));
    cells.second[d] = static_cast<Index>(std::lround(high));
  }
  return cells;
}

template <class Visit> void for_each_cell(const std::pair<Site<3>, Site<3>>& box, Visit&& visit)
{
  for (Site<3> at = box.first; at[2] < box.second[2]; ++at[2])
    for (at[1] = box.first[1]; at[1] < box.second[1]; ++at[1])
      for (at[0] = box.first[0]; at[0] < box.second[0]; ++at[0]) visit(std::as_const(at));
}

/// Why a cell that is asked for cannot be particles.
std::string reason(const mpm::Body<3>& of, SpaceBodies::Stays why)
{
  if (why == SpaceBodies::kNotFull)
    return "is not full of points: particles take whole cells; keep patches away from a round or slanted border";
  if (why == SpaceBodies::kOther)
    return fmt::format(
        "cannot be particles, which are of -material_young, _poisson and _density and -pd_spacing apart: "
        "give {} the same",
        of.name);
  return "is held at a side: points there stay; keep patches a cell away from it";
}

std::vector<mpm::GridPlace<3>> given_cells(const options::SceneOptions& options, const SpaceBodies& bodies)
{
  std::vector<mpm::GridPlace<3>> cells;
  for (const geom::Box<3>& box : options.pd.boxes) {
    std::optional<std::pair<Site<3>, Site<3>>> found;
    for (std::size_t b = 0; b < bodies.points.bodies.size() && !found; ++b) {
      const mpm::Body<3>& of = bodies.points.bodies[b];
      found = cells_in(of, box);
      if (!found) continue;
      for_each_cell(*found, [&](const Site<3>& at) {
        const mpm::GridPlace<3> cell{static_cast<Index>(b), at};
        if (const auto why = bodies.why_stays(cell); why != SpaceBodies::kFree)
          throw UserError(fmt::format("-pd_patches: the cell of {} at {} {}", of.name, text(options.frame, of.node(at)),
                                      reason(of, why)));
        cells.push_back(cell);
      });
    }
    if (found) continue;
    const mpm::Body<3>& first = bodies.points.bodies.front();
    throw UserError(
        fmt::format("-pd_patches: the box from {} to {} is not made of whole cells of one body: those of {} "
                    "are {:g} m wide and begin at {}",
                    text(options.frame, box.lower), text(options.frame, box.upper), first.name, first.cell_size(),
                    text(options.frame, first.corner)));
  }
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

pd::Stencil<3> stencil_of(const options::SceneOptions& options)
{
  const double dx = options.pd.spacing[0];
  try {
    auto stencil = pd::make_stencil<3>(
        {dx, 1.0, options.pd.horizon_ratio * dx, options.pd.micromodulus, options.pd.calibration, options.elastic});
    pd::require_bond_words(stencil);
    return stencil;
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("-pd_horizon_ratio is {}: {}", options.pd.horizon_ratio, wrong.what()));
  }
}

void judge_cells(const options::SceneOptions& options, SpaceBodies& bodies)
{
  const law::Elastic& e = options.elastic;
  bodies.stays = side_held_cells(options, bodies.points);
  for (std::size_t b = 0; b < bodies.points.bodies.size(); ++b) {
    const mpm::Body<3>& of = bodies.points.bodies[b];
    const law::Elastic& own = of.material.elastic;
    const bool same = own.young == e.young && own.poisson == e.poisson && own.density == e.density &&
                      std::abs(of.material.spacing / options.pd.spacing[0] - 1.0) < 1e-9;
    for (std::size_t k = 0; k < of.points.size(); ++k) {
      std::uint8_t& why = bodies.stays[b][k];
      why = why ? SpaceBodies::kHeld : SpaceBodies::kFree;
      if (!same) why = SpaceBodies::kOther;
      if (of.points[k] != mpm::full_mask<3>(of.material.ratio)) why = SpaceBodies::kNotFull;
    }
  }
}
} // namespace space_plan

SpaceBodies::Stays SpaceBodies::why_stays(const mpm::GridPlace<3>& cell) const
{
  const auto b = static_cast<std::size_t>(cell.body);
  const mpm::Body<3>& of = points.bodies[b];
  for (std::size_t d = 0; d < 3; ++d)
    if (cell.at[d] < 0 || cell.at[d] >= of.cells[d]) return kNotFull;
  return static_cast<Stays>(stays[b][static_cast<std::size_t>(of.number(cell.at))]);
}

SpaceBodies settle_in_space(options::SceneOptions& options)
{
  SpaceBodies bodies{plan_points<3>(options, std::numeric_limits<double>::infinity()), {}, {}, {}, {}};
  std::uint64_t first = 0;
  for (const mpm::Body<3>& of : bodies.points.bodies) {
    geom::SpaceNames names;
    for (std::size_t d = 0; d < 3; ++d) names.count[d] = of.cells[d] * of.material.ratio;
    names.first = first;
    first += names.size();
    bodies.names.push_back(names);
  }
  bodies.stencil = space_plan::stencil_of(options);
  bodies.sides = solid_sides(options.pd, *bodies.stencil, false);
  space_plan::judge_cells(options, bodies);
  options.pd.cells = space_plan::given_cells(options, bodies);
  return bodies;
}

SpacePlan::SpacePlan(const SpaceBodies& bodies, const std::vector<mpm::GridPlace<3>>& taken)
    : cells(taken.begin(), taken.end())
{
  for (const mpm::GridPlace<3>& cell : taken)
    if (bodies.why_stays(cell) != SpaceBodies::kFree)
      throw UserError(fmt::format("a checkpoint has particles in the cell {} {} {} of {}, where this scene has none to "
                                  "convert",
                                  cell.at[0], cell.at[1], cell.at[2],
                                  bodies.points.bodies[static_cast<std::size_t>(cell.body)].name));
  for (std::size_t b = 0; b < bodies.points.bodies.size(); ++b) {
    const mpm::Body<3>& of = bodies.points.bodies[b];
    const Index ratio = of.material.ratio;
    std::vector<geom::SiteSet<3>::Corners> boxes;
    for (const auto& [body, at] : taken) {
      if (body != static_cast<Index>(b)) continue;
      geom::SiteSet<3>::Corners box;
      for (std::size_t d = 0; d < 3; ++d) {
        box.first[d] = at[d] * ratio;
        box.second[d] = (at[d] + 1) * ratio;
      }
      boxes.push_back(box);
    }
    if (boxes.empty()) continue;
    const geom::Lattice<3> lattice{of.corner, of.material.spacing, bodies.names[b].count};
    shapes.push_back({&of,
                      static_cast<Index>(b),
                      {lattice, geom::SiteSet<3>(boxes)},
                      bodies.names[b],
                      couple::face_share(*bodies.stencil)});
  }
}

std::vector<pd::Particle> SpacePlan::particles(const SpaceBodies& bodies, const mesh::Mesh& mesh) const
{
  std::vector<pd::Particle> mine;
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    const auto& column = bodies.points.cells[static_cast<std::size_t>(mesh.natural_cell(c))];
    const auto shape = std::ranges::find(shapes, column.body, &couple::SpaceShape::body);
    if (shape == shapes.end()) continue;
    const Index ratio = shape->of->material.ratio;
    for (const Index layer : bodies.points.cell_layers(column)) {
      if (!cells.contains({column.body, {column.at[0], column.at[1], layer}})) continue;
      const Site<3> low{column.at[0] * ratio, column.at[1] * ratio, layer * ratio};
      space_plan::for_each_cell({low, {low[0] + ratio, low[1] + ratio, low[2] + ratio}}, [&](const Site<3>& site) {
        mine.push_back({static_cast<Index>(shape - shapes.begin()), static_cast<Index>(shape->where.active.place(site)),
                        c, shape->where.lattice.point(site).head<2>()});
      });
    }
  }
  std::ranges::sort(mine, {}, [](const pd::Particle& p) { return std::pair(p.patch, p.site); });
  return mine;
}
} // namespace pdx::scene
