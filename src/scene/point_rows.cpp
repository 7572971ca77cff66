#include "pdx/mesh/vertex_halo.hpp"
#include "pdx/scene/point_body.hpp"

#include <algorithm>
#include <numeric>

namespace pdx::scene {
namespace {
template <int Dim> Site<Dim> in_column(const std::array<Index, 2>& at, Index layer)
{
  Site<Dim> site{};
  site[0] = at[0];
  site[1] = at[1];
  if constexpr (Dim == 3) site[2] = layer;
  return site;
}

/// Number of a column's first node among those of all columns in natural order, and that behind the last.
template <int Dim> std::vector<std::int64_t> first_nodes(const PointPlan<Dim>& plan)
{
  std::vector<std::int64_t> first{0};
  for (const auto& column : plan.nodes)
    first.push_back(first.back() + static_cast<std::int64_t>(plan.node_layers(column).size()));
  return first;
}

/// Owned vertices in natural order: rows of a line of the grid follow each other.
std::vector<Index> in_natural_order(const mesh::Mesh& mesh)
{
  std::vector<Index> order(static_cast<std::size_t>(mesh.owned_vertices()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&mesh](Index v) { return mesh.natural_vertex(v); });
  return order;
}
} // namespace

template <int Dim>
PointRows<Dim>::PointRows(const PointPlan<Dim>& plan, const mesh::Mesh& mesh, const TakenCells<Dim>* taken)
{
  const auto column_of = [&](Index v) -> const auto&
  {
    return plan.nodes[static_cast<std::size_t>(mesh.natural_vertex(v))];
  };
  const auto is_taken = [taken](Index of, const Site<Dim>& at) { return taken && taken->has({of, at}); };
  // Does a cell at the node have points still?
  const auto lives = [&](Index of, const Site<Dim>& node) {
    if (!taken) return true;
    for (unsigned around = 0; around < 1U << Dim; ++around) {
      Site<Dim> cell = node;
      for (std::size_t d = 0; d < Dim; ++d) cell[d] -= static_cast<Index>(around >> d & 1U);
      if (plan.bodies[static_cast<std::size_t>(of)].points_in(cell) != 0 && !is_taken(of, cell)) return true;
    }
    return false;
  };
  std::vector<std::vector<Index>> living(static_cast<std::size_t>(mesh.vertices())); // layers of nodes with a row
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const auto& column = column_of(v);
    auto& layers = living[static_cast<std::size_t>(v)] = plan.node_layers(column);
    std::erase_if(layers, [&](Index layer) { return !lives(column.body, in_column<Dim>(column.at, layer)); });
  }
  const std::vector<std::int64_t> first_node = first_nodes(plan);
  std::vector<PetscInt> first_row(static_cast<std::size_t>(mesh.vertices()), 0);
  for (const Index v : in_natural_order(mesh)) {
    const auto& column = column_of(v);
    const mpm::Body<Dim>& of = plan.bodies[static_cast<std::size_t>(column.body)];
    first_row[static_cast<std::size_t>(v)] = static_cast<PetscInt>(body.size());
    std::int64_t node = first_node[static_cast<std::size_t>(mesh.natural_vertex(v))];
    for (const Index layer : plan.node_layers(column)) {
      const Site<Dim> at = in_column<Dim>(column.at, layer);
      const auto name = field::RowName::node(static_cast<Index>(node++));
      if (!lives(column.body, at)) continue;
      body.push_back(column.body);
      place.push_back(of.node(at));
      nodes.push_back({column.body, at});
      names.push_back(name);
    }
  }
  const std::size_t particles = taken ? taken->particles.size() : 0;
  rows = field::Rows::number(mesh.comm(), Dim, static_cast<Index>(nodes.size()), 0, static_cast<Index>(particles));
  for (std::size_t k = 0; k < particles; ++k) {
    const auto& [of, site] = taken->particles[k];
    body.push_back(of);
    place.push_back(plan.bodies[static_cast<std::size_t>(of)].place_of(site));
  }
  for (Index v = 0; v < mesh.owned_vertices(); ++v) first_row[static_cast<std::size_t>(v)] += rows.first;
  mesh::fill_halo(mesh, MPIU_INT, 1, first_row.data());

  const auto row_at = [&](Index v, Index layer) {
    const std::vector<Index>& layers = living[static_cast<std::size_t>(v)];
    return first_row[static_cast<std::size_t>(v)] +
           static_cast<PetscInt>(std::ranges::lower_bound(layers, layer) - layers.begin());
  };
  static constexpr std::size_t kAround[] = {0, 1, 3, 2}; // corners of a cell, counter-clockwise, as x fastest
  for (Index c = 0; c < mesh.cells(); ++c) {
    const auto& column = plan.cells[static_cast<std::size_t>(mesh.natural_cell(c))];
    for (const Index layer : plan.cell_layers(column)) {
      Cell cell{{column.body, in_column<Dim>(column.at, layer)}, {}};
      if (is_taken(cell.body, cell.at)) continue;
      for (std::size_t corner = 0; corner < cell.rows.size(); ++corner)
        cell.rows[corner] = row_at(mesh.cell(c)[kAround[corner & 3]], layer + static_cast<Index>(corner >> 2));
      cells.push_back(cell);
    }
    if (c < mesh.owned_cells()) owned = cells.size();
  }
}

template struct PointRows<2>;
template struct PointRows<3>;
} // namespace pdx::scene
