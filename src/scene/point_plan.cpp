#include "pdx/scene/point_plan.hpp"

#include "pdx/mesh/gmsh.hpp"
#include "pdx/scene/body_overlap.hpp"
#include "pdx/scene/point_shapes.hpp"
#include "pdx/scene/settle.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace pdx::scene {
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
template <int Dim> void settle_points(options::SceneOptions& options, double edge)
{
  constexpr double far = std::numeric_limits<double>::max();
  geom::Box<3> all{Vector<3>::Constant(far), Vector<3>::Constant(-far)};
  double finest = std::min(far, edge);
  for (const double dx : options.pd.spacing) finest = std::min(finest, dx);
  if (options.mesh.list || options.mesh.cells[0] > 0) {
    all.lower.head<2>() = options.mesh.box.lower;
    all.upper.head<2>() = options.mesh.box.upper;
  }
  for (const options::PointBodyOptions& body : options.points.bodies) {
    const geom::Box<3> box = body.shape.file.empty() ? body.shape.around() : around_file<Dim>(body);
    all.lower = all.lower.cwiseMin(box.lower).eval();
    all.upper = all.upper.cwiseMax(box.upper).eval();
    finest = std::min(finest, body.spacing);
  }
  if (Dim == 2) all.lower[2] = all.upper[2] = 0.0;
  move_into(geom::Frame(all), finest, options);
  for (options::PointBodyOptions& body : options.points.bodies) body.shape = body.shape.inside(options.frame);
}

/// Columns of cells with points, and of nodes that they touch, of one body, behind what is there.
template <int Dim> class ColumnsOfBody {
public:
  ColumnsOfBody(PointPlan<Dim>& plan, mesh::CellList& list, std::size_t body)
      : plan_(plan), list_(list), body_(plan.bodies[body]), number_(static_cast<Index>(body)), nx_(body_.cells[0]),
        ny_(body_.cells[1]), vertex_(static_cast<std::size_t>(nx_ + 1) * static_cast<std::size_t>(ny_ + 1), -1)
  {}

  void lay(bool with_costs)
  {
    for (Index j = 0; j < ny_; ++j)
      for (Index i = 0; i < nx_; ++i)
        if (points(i, j) > 0) node(i, j) = node(i + 1, j) = node(i, j + 1) = node(i + 1, j + 1) = 0;
    for (Index j = 0; j <= ny_; ++j)
      for (Index i = 0; i <= nx_; ++i) {
        if (node(i, j) < 0) continue;
        node(i, j) = static_cast<Index>(list_.points.size());
        list_.points.push_back(body_.node(site_of<Dim>({i, j}, 0)).template head<2>());
        plan_.nodes.push_back({number_, {i, j}});
      }
    for (Index j = 0; j < ny_; ++j)
      for (Index i = 0; i < nx_; ++i) {
        const int count = points(i, j);
        if (count == 0) continue;
        list_.cells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
        if (with_costs) list_.costs.push_back(count);
        plan_.cells.push_back({number_, {i, j}});
      }
  }

  /// Edges along the sides of the box around the body, where lines of the grid lie there.
  void name_sides(std::span<const std::pair<Index, Index>, 4> names)
  {
    const geom::Box<Dim> around = body_.around();
    const auto on = [&](Index k, Eigen::Index axis, double side) {
      return std::abs(body_.corner[axis] + k * body_.cell_size() - side) < 1e-6 * body_.material.spacing;
    };
    const auto add = [&](std::size_t side, Index a, Index b) {
      if (a < 0 || b < 0) return;
      for (const Index name : {names[side].first, names[side].second}) list_.edges.push_back({{a, b}, name});
    };
    const auto filled = [&](Index i, Index j) { return i >= 0 && j >= 0 && i < nx_ && j < ny_ && points(i, j) > 0; };
    for (Index j = 0; j < ny_; ++j)
      for (Index i = 0; i < nx_; ++i) {
        if (!filled(i, j)) continue;
        if (on(i, 0, around.lower[0]) && !filled(i - 1, j)) add(0, node(i, j), node(i, j + 1));
        if (on(i + 1, 0, around.upper[0]) && !filled(i + 1, j)) add(1, node(i + 1, j), node(i + 1, j + 1));
        if (on(j, 1, around.lower[1]) && !filled(i, j - 1)) add(2, node(i, j), node(i + 1, j));
        if (on(j + 1, 1, around.upper[1]) && !filled(i, j + 1)) add(3, node(i, j + 1), node(i + 1, j + 1));
      }
  }

private:
  Index& node(Index i, Index j) { return vertex_[static_cast<std::size_t>(i + (nx_ + 1) * j)]; }
  int points(Index i, Index j) const
  {
    int count = 0;
    for (Index k = 0; k < layers_of(body_); ++k) count += std::popcount(body_.points_in(site_of<Dim>({i, j}, k)));
    return count;
  }

  PointPlan<Dim>& plan_;
  mesh::CellList& list_;
  const mpm::Body<Dim>& body_;
  Index number_, nx_, ny_;
  std::vector<Index> vertex_; // of nodes of the grid, -1 for none
};

Index named(mesh::CellList& list, const std::string& name)
{
  const auto known = std::ranges::find(list.boundaries, name);
  if (known != list.boundaries.end()) return static_cast<Index>(known - list.boundaries.begin());
  list.boundaries.push_back(name);
  return static_cast<Index>(list.boundaries.size()) - 1;
}

/// The elements of a box as a list.
mesh::CellList box_list(const mesh::MeshOptions& options)
{
  mesh::CellList list;
  const Index nx = options.cells[0], ny = options.cells[1];
  const auto node = [nx](Index i, Index j) { return i + (nx + 1) * j; };
  const auto line = [&](Eigen::Index d, Index k) {
    const Index n = options.cells[static_cast<std::size_t>(d)];
    return k == n ? options.box.upper[d] : options.box.lower[d] + options.box.size()[d] * k / n;
  };
  for (Index j = 0; j <= ny; ++j)
    for (Index i = 0; i <= nx; ++i) list.points.emplace_back(line(0, i), line(1, j));
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i)
      list.cells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
  list.boundaries = {"left", "right", "bottom", "top"};
  for (Index j = 0; j < ny; ++j) {
    list.edges.push_back({{node(0, j), node(0, j + 1)}, 0});
    list.edges.push_back({{node(nx, j), node(nx, j + 1)}, 1});
  }
  for (Index i = 0; i < nx; ++i) {
    list.edges.push_back({{node(i, 0), node(i + 1, 0)}, 2});
    list.edges.push_back({{node(i, ny), node(i + 1, ny)}, 3});
  }
  return list;
}

/// The elements of a scene, their boundaries by a second name too.
mesh::CellList elements_of(const mesh::MeshOptions& options)
{
  if (options.list == nullptr && options.cells[0] == 0) return {};
  mesh::CellList list = options.list ? *options.list : box_list(options);
  const auto first = static_cast<Index>(list.boundaries.size());
  for (Index name = 0; name < first; ++name)
    list.boundaries.push_back("mesh:" + list.boundaries[static_cast<std::size_t>(name)]);
  const std::vector<mesh::CellList::Edge> edges = list.edges;
  for (const auto& edge : edges) list.edges.push_back({edge.vertices, edge.name + first});
  return list;
}

/// Columns of all bodies as a mesh, behind the elements where there are any.
template <int Dim> void lay_columns(const options::SceneOptions& options, PointPlan<Dim>& plan)
{
  auto list = std::make_shared<mesh::CellList>(options.mixed() ? elements_of(options.mesh) : mesh::CellList{});
  plan.first_cell = static_cast<Index>(list->cells.size());
  plan.first_node = static_cast<Index>(list->points.size());
  for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
    ColumnsOfBody<Dim> columns(plan, *list, b);
    columns.lay(!options.mixed());
    if (!options.mixed()) continue;
    std::array<std::pair<Index, Index>, 4> names;
    for (std::size_t side = 0; side < 4; ++side) {
      const std::string name = std::array{"left", "right", "bottom", "top"}[side];
      names[side] = {named(*list, name), named(*list, plan.bodies[b].name + ":" + name)};
    }
    columns.name_sides(names);
  }
  plan.mesh.file = "points"; // that its cells are a list
  constexpr double far = std::numeric_limits<double>::max();
  plan.mesh.box = {Vector<2>::Constant(far), Vector<2>::Constant(-far)};
  for (const Vector<2>& x : list->points) {
    plan.mesh.box.lower = plan.mesh.box.lower.cwiseMin(x).eval();
    plan.mesh.box.upper = plan.mesh.box.upper.cwiseMax(x).eval();
  }
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

template <int Dim> std::vector<mpm::BodyMaterial> PointPlan<Dim>::materials() const
{
  std::vector<mpm::BodyMaterial> all;
  for (const mpm::Body<Dim>& body : bodies) all.push_back(body.material);
  return all;
}

template <int Dim> PointPlan<Dim> plan_points(options::SceneOptions& options, double edge)
{
  settle_points<Dim>(options, edge);
  PointPlan<Dim> plan;
  for (const options::PointBodyOptions& body : options.points.bodies)
    plan.bodies.push_back(
        body_of<Dim>(body, {body.elastic, options.points.law, body.spacing, options.points.ratio}, options.frame));
  if (options.points.contact.active) refuse_overlap(plan, options.frame);
  lay_columns(options, plan);
  return plan;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template struct PointPlan<Dim>;                                                                                      \
  template PointPlan<Dim> plan_points<Dim>(options::SceneOptions&, double)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::scene
