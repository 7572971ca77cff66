#include "pdx/adapt/space_conversion.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <map>

namespace pdx::adapt {
namespace space_fill {
constexpr std::size_t kMost = 2; // fields

/// What a node has of each field.
struct Values {
  mpm::GridPlace<3> node;
  std::array<std::array<double, 3>, kMost> of;
};
using Nodes = std::map<mpm::GridPlace<3>, std::array<Vector<3>, kMost>>;

mpm::GridPlace<3> shifted(mpm::GridPlace<3> place, std::size_t axis, Index by)
{
  place.at[axis] += by;
  return place;
}

/// Of the nodes of some cells and those beside them, of all ranks. Collective.
Nodes gathered(const SpaceView& scene, const SpaceCells& cells, std::span<const std::span<const double>> fields)
{
  std::map<mpm::GridPlace<3>, bool> wanted;
  for (const mpm::GridPlace<3>& cell : cells)
    for (Index k = -1; k <= 2; ++k)
      for (Index j = -1; j <= 2; ++j)
        for (Index i = -1; i <= 2; ++i) wanted[{cell.body, {cell.at[0] + i, cell.at[1] + j, cell.at[2] + k}}] = true;
  std::vector<Values> mine;
  for (std::size_t row = 0; row < scene.nodes.size(); ++row) {
    if (!wanted.contains(scene.nodes[row])) continue;
    Values values{scene.nodes[row], {}};
    for (std::size_t f = 0; f < fields.size(); ++f) std::copy_n(&fields[f][3 * row], 3, values.of[f].begin());
    mine.push_back(values);
  }
  Nodes nodes;
  for (const Values& values : gather_all(scene.halo.rows().comm, mine))
    for (std::size_t f = 0; f < fields.size(); ++f)
      nodes[values.node][f] = Eigen::Map<const Vector<3>>(values.of[f].data());
  return nodes;
}

/// d f / d x_axis at a node, times the side of a cell; none where the node beside it on one side has no row.
std::optional<Vector<3>> slope(const Nodes& nodes, const mpm::GridPlace<3>& node, std::size_t axis, std::size_t field)
{
  const auto below = nodes.find(shifted(node, axis, -1)), above = nodes.find(shifted(node, axis, 1));
  if (below == nodes.end() || above == nodes.end()) return std::nullopt;
  return 0.5 * (above->second[field] - below->second[field]);
}

/// sum of N_a (u_a + g_a (x - x_a) / 2), direction by direction where both ends have a gradient.
/// @param x in the cell, 0 to 1
Vector<3> value_at(const Nodes& nodes, const mpm::GridPlace<3>& cell, const Vector<3>& x, std::size_t field)
{
  Vector<3> value = Vector<3>::Zero();
  std::array<Vector<3>, 3> bends{Vector<3>::Zero(), Vector<3>::Zero(), Vector<3>::Zero()};
  std::array<bool, 3> bent{true, true, true};
  for (unsigned corner = 0; corner < 8; ++corner) {
    mpm::GridPlace<3> node = cell;
    double weight = 1.0;
    for (std::size_t d = 0; d < 3; ++d) {
      const bool upper = corner >> d & 1U;
      const double at = x[static_cast<Eigen::Index>(d)];
      node.at[d] += upper;
      weight *= upper ? at : 1.0 - at;
    }
    value += weight * nodes.at(node)[field];
    for (std::size_t d = 0; d < 3; ++d) {
      const std::optional<Vector<3>> g = slope(nodes, node, d, field);
      bent[d] = bent[d] && g;
      if (g) bends[d] += 0.5 * weight * (x[static_cast<Eigen::Index>(d)] - (corner >> d & 1U)) * *g;
    }
  }
  for (std::size_t d = 0; d < 3; ++d)
    if (bent[d]) value += bends[d];
  return value;
}
} // namespace space_fill

FreshRows fill(const SpaceView& scene, const SpaceCells& cells, std::span<const std::span<const double>> fields)
{
  using namespace space_fill;
  FreshRows fresh;
  fresh.fields.resize(fields.size());
  const Nodes nodes = gathered(scene, cells, fields);
  for (const mpm::GridPlace<3>& cell : scene.cells) {
    if (!std::ranges::binary_search(cells, static_cast<const mpm::GridPlace<3>&>(cell))) continue;
    const Index ratio = scene.bodies[static_cast<std::size_t>(cell.body)].material.ratio;
    for (Index number = 0; number < ratio * ratio * ratio; ++number) {
      const Site<3> in{number % ratio, number / ratio % ratio, number / (ratio * ratio)};
      Site<3> site{};
      Vector<3> x;
      for (std::size_t d = 0; d < 3; ++d) {
        site[d] = cell.at[d] * ratio + in[d];
        x[static_cast<Eigen::Index>(d)] = (in[d] + 0.5) / ratio;
      }
      fresh.names.push_back(field::RowName::particle(scene.names[static_cast<std::size_t>(cell.body)].of(site)));
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const Vector<3> value = value_at(nodes, cell, x, f);
        fresh.fields[f].insert(fresh.fields[f].end(), {value[0], value[1], value[2]});
      }
    }
  }
  return fresh;
}
} // namespace pdx::adapt
