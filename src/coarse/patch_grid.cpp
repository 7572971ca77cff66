#include "pdx/coarse/patch_grid.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace pdx::coarse {
namespace {
constexpr double kFreeCell = 4.0;   // width of a cell without elements around the patch, in spacings
constexpr double kWidestCell = 5.5; // elements wider than that are divided
} // namespace

PatchGrid::PatchGrid(const pd::LatticePart<2>& part, const couple::Surroundings& around) : part_(part), around_(around)
{
  const double dx = part.lattice().dx;
  double width = kFreeCell * dx;
  if (const double edge = around.shortest_edge(); std::isfinite(edge))
    width = edge / std::ceil(edge / (kWidestCell * dx));
  for (std::size_t d = 0; d < 2; ++d) divide(d, width);
  carried_.assign(static_cast<std::size_t>(nodes()), 0);
  for (Index node = 0; node < nodes(); ++node) {
    bool used = false;
    for_each_cell_at(node, [&used](Index) { used = true; });
    if (!used) continue;
    if (around.edge_host(point(node), Vector<2>::Zero())) {
      carried_[static_cast<std::size_t>(node)] = 1;
      continue;
    }
    const Index row = part.row(particle_at(node)) - part.first_row();
    if (row >= 0 && row < static_cast<Index>(part.sites().size())) owned_.push_back(node);
  }
}

void PatchGrid::divide(std::size_t d, double width)
{
  const couple::PatchShape& shape = around_.shape();
  const double dx = part_.lattice().dx;
  std::set<Index> ends{0, part_.lattice().count[d]};
  for (const geom::StraightSide& side : geom::straight_sides(part_.active()))
    if (side.axis == d) ends.insert(side.at);
  Axis& axis = axes_[d];
  for (auto end = std::next(ends.begin()); end != ends.end(); ++end) {
    const Index from = *std::prev(end), sites = *end - from;
    const double start = shape.line(d, from), length = shape.line(d, *end) - start;
    const Index cells = std::clamp(static_cast<Index>(std::round(length / width)), Index{1}, sites);
    const double size = length / cells;
    const auto before = static_cast<Index>(axis.gap.size());
    for (Index k = 0; k < cells; ++k) {
      axis.lines.push_back(start + k * size);
      axis.gap.push_back(axis.sizes.size());
    }
    axis.sizes.push_back(size);
    for (Index k = 0; k < sites; ++k)
      axis.column.push_back(
          before + std::clamp(static_cast<Index>(std::floor((k + 0.5) * dx / size + 1e-9)), Index{0}, cells - 1));
  }
  axis.lines.push_back(shape.line(d, *ends.rbegin()));
  cells_[d] = static_cast<Index>(axis.gap.size());
  for (Index column = 0; column <= cells_[d]; ++column)
    axis.first.push_back(static_cast<Index>(std::ranges::lower_bound(axis.column, column) - axis.column.begin()));
}

/// A particle of the patch next to a node, where it can upwards and to the right.
Site<2> PatchGrid::particle_at(Index node) const
{
  const geom::Lattice<2>& lattice = part_.lattice();
  const Vector<2> x = point(node) - around_.shape().box.lower;
  Site<2> site{}, above{}, below{};
  for (std::size_t d = 0; d < 2; ++d) {
    const double at = x[static_cast<Eigen::Index>(d)] / lattice.dx, line = std::round(at);
    site[d] = std::clamp(static_cast<Index>(std::floor(at)), Index{0}, lattice.count[d] - 1);
    above[d] = static_cast<Index>(std::abs(at - line) < 1e-6 ? line : std::floor(at));
    below[d] = static_cast<Index>(std::abs(at - line) < 1e-6 ? line - 1.0 : std::floor(at));
  }
  for (const Site<2>& other : {site, above, Site<2>{below[0], above[1]}, Site<2>{above[0], below[1]}, below})
    if (part_.active().has(other)) return other;
  throw std::logic_error("a node of a patch's grid without a particle");
}

std::size_t PatchGrid::kind(Index cell) const
{
  return axes_[1].gap[static_cast<std::size_t>(cell / cells_[0])] * axes_[0].sizes.size() +
         axes_[0].gap[static_cast<std::size_t>(cell % cells_[0])];
}

Vector<2> PatchGrid::size_of(std::size_t kind) const
{
  return {axes_[0].sizes[kind % axes_[0].sizes.size()], axes_[1].sizes[kind / axes_[0].sizes.size()]};
}

Vector<2> PatchGrid::point(Index node) const
{
  return {axes_[0].lines[static_cast<std::size_t>(node % (cells_[0] + 1))],
          axes_[1].lines[static_cast<std::size_t>(node / (cells_[0] + 1))]};
}

couple::Host PatchGrid::host(Index node, const Vector<2>& x) const
{
  const Vector<2> at = point(node);
  const auto seen = around_.edge_host(at, x - at);
  return seen ? *seen : *around_.edge_host(at, Vector<2>::Zero()); // beyond a seam: near enough for a coarse level
}

std::array<Index, 4> PatchGrid::corners(Index cell) const
{
  const Index first = cell / cells_[0] * (cells_[0] + 1) + cell % cells_[0], above = first + cells_[0] + 1;
  return {first, first + 1, above + 1, above};
}

Index PatchGrid::cell_of(const Site<2>& site) const
{
  return axes_[1].column[static_cast<std::size_t>(site[1])] * cells_[0] +
         axes_[0].column[static_cast<std::size_t>(site[0])];
}

std::pair<Site<2>, Site<2>> PatchGrid::sites(Index cell) const
{
  const std::array<Index, 2> at{cell % cells_[0], cell / cells_[0]};
  Site<2> lower{}, upper{};
  for (std::size_t d = 0; d < 2; ++d) {
    lower[d] = axes_[d].first[static_cast<std::size_t>(at[d])];
    upper[d] = axes_[d].first[static_cast<std::size_t>(at[d]) + 1];
  }
  return {lower, upper};
}

std::array<double, 4> PatchGrid::weights(Index cell, const Vector<2>& x) const
{
  const Vector<2> t = (x - point(corners(cell)[0])).array() / size_of(kind(cell)).array();
  return {(1.0 - t[0]) * (1.0 - t[1]), t[0] * (1.0 - t[1]), t[0] * t[1], (1.0 - t[0]) * t[1]};
}
} // namespace pdx::coarse
