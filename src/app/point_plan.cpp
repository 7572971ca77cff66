#include "pdx/app/point_plan.hpp"

#include "pdx/app/point_shapes.hpp"
#include "pdx/app/settle.hpp"
#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace pdx::app {
namespace {
template <int Dim> Site<Dim> site_of(const std::array<Index, 2>& at, Index layer)
{
  if constexpr (Dim == 2)
    return {at[0], at[1]};
  else
    return {at[0], at[1], layer};
}

template <int Dim> Index layers_of(const mpm::Body<Dim>& body)
{
  if constexpr (Dim == 2)
    return 1;
  else
    return body.cells[2];
}

/// Around all bodies, as given, and the finest spacing; moves the shapes into the frame of that box [m].
template <int Dim> void settle_points(SceneOptions& options)
{
  constexpr double far = std::numeric_limits<double>::max();
  geom::Box<3> all{Vector<3>::Constant(far), Vector<3>::Constant(-far)};
  double finest = far;
  for (const PointBodyOptions& body : options.points.bodies) {
    const geom::Box<3> box = body.shape.file.empty() ? body.shape.around() : around_file<Dim>(body);
    all.lower = all.lower.cwiseMin(box.lower).eval();
    all.upper = all.upper.cwiseMax(box.upper).eval();
    finest = std::min(finest, body.spacing);
  }
  if (Dim == 2) all.lower[2] = all.upper[2] = 0.0;
  move_into(geom::Frame(all), finest, options);
  for (PointBodyOptions& body : options.points.bodies) body.shape = body.shape.inside(options.frame);
}

/// Columns of cells with points, those of nodes that they touch, and both as a mesh.
template <int Dim> void lay_columns(PointPlan<Dim>& plan)
{
  auto list = std::make_shared<mesh::CellList>();
  for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
    const mpm::Body<Dim>& body = plan.bodies[b];
    const auto number = static_cast<Index>(b);
    const Index nx = body.cells[0], ny = body.cells[1];
    std::vector<int> cost(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), 0);
    std::vector<Index> vertex(static_cast<std::size_t>(nx + 1) * static_cast<std::size_t>(ny + 1), -1);
    const auto node = [&](Index i, Index j) -> Index& { return vertex[static_cast<std::size_t>(i + (nx + 1) * j)]; };
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        int& points = cost[static_cast<std::size_t>(i + nx * j)];
        for (Index k = 0; k < layers_of(body); ++k) points += std::popcount(body.points_in(site_of<Dim>({i, j}, k)));
        if (points > 0) node(i, j) = node(i + 1, j) = node(i, j + 1) = node(i + 1, j + 1) = 0;
      }
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i) {
        if (node(i, j) < 0) continue;
        node(i, j) = static_cast<Index>(list->points.size());
        list->points.push_back(body.node(site_of<Dim>({i, j}, 0)).template head<2>());
        plan.nodes.push_back({number, {i, j}});
      }
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        const int points = cost[static_cast<std::size_t>(i + nx * j)];
        if (points == 0) continue;
        list->cells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
        list->costs.push_back(points);
        plan.cells.push_back({number, {i, j}});
      }
  }
  plan.mesh.file = "points"; // that its cells are a list
  plan.mesh.list = std::move(list);
}
} // namespace

template <int Dim> std::vector<Index> PointPlan<Dim>::cell_layers(const Column& column) const
{
  const mpm::Body<Dim>& body = bodies[static_cast<std::size_t>(column.body)];
  std::vector<Index> layers;
  for (Index k = 0; k < layers_of(body); ++k)
    if (body.points_in(site_of<Dim>(column.at, k)) != 0) layers.push_back(k);
  return layers;
}

template <int Dim> std::vector<Index> PointPlan<Dim>::node_layers(const Column& column) const
{
  if constexpr (Dim == 2)
    return {0};
  else {
    const mpm::Body<Dim>& body = bodies[static_cast<std::size_t>(column.body)];
    std::vector<Index> layers;
    for (Index k = 0; k <= body.cells[2]; ++k) {
      std::uint64_t near = 0;
      for (Index c = 0; c < 8; ++c)
        near |= body.points_in({column.at[0] - (c & 1), column.at[1] - (c >> 1 & 1), k - (c >> 2)});
      if (near != 0) layers.push_back(k);
    }
    return layers;
  }
}

template <int Dim> std::int64_t PointPlan<Dim>::count() const
{
  std::int64_t n = 0;
  for (const mpm::Body<Dim>& body : bodies) n += body.count();
  return n;
}

template <int Dim> PointPlan<Dim> plan_points(SceneOptions& options)
{
  settle_points<Dim>(options);
  PointPlan<Dim> plan;
  for (const PointBodyOptions& body : options.points.bodies)
    plan.bodies.push_back(
        body_of<Dim>(body, {body.elastic, options.points.law, body.spacing, options.points.ratio}, options.frame));
  lay_columns(plan);
  return plan;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template struct PointPlan<Dim>;                                                                                      \
  template PointPlan<Dim> plan_points<Dim>(SceneOptions&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::app
