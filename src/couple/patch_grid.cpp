#include "pdx/couple/patch_grid.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::couple {
namespace {
constexpr double kFreeCell = 4.0;   // width of a cell without elements around the patch, in spacings
constexpr double kWidestCell = 5.5; // elements wider than that are divided
} // namespace

PatchGrid::PatchGrid(const pd::LatticePart<2>& part, const Surroundings& around) : part_(part), around_(around)
{
  const geom::Lattice<2>& lattice = part.lattice();
  const geom::Box<2>& box = around.shape().box;
  double width = kFreeCell * lattice.dx;
  if (const double edge = around.shortest_edge(); std::isfinite(edge))
    width = edge / std::ceil(edge / (kWidestCell * lattice.dx));
  for (std::size_t d = 0; d < 2; ++d) {
    const auto e = static_cast<Eigen::Index>(d);
    cells_[d] = std::clamp(static_cast<Index>(std::round(box.size()[e] / width)), Index{1}, lattice.count[d]);
    size_[e] = box.size()[e] / cells_[d];
  }
  carried_.assign(static_cast<std::size_t>(nodes()), 0);
  for (Index node = 0; node < nodes(); ++node) {
    const Vector<2> x = point(node);
    const Index i = node % (cells_[0] + 1), j = node / (cells_[0] + 1);
    const bool border = i == 0 || j == 0 || i == cells_[0] || j == cells_[1];
    if (border && around.edge_host(x, Vector<2>::Zero())) {
      carried_[static_cast<std::size_t>(node)] = 1;
      continue;
    }
    Site<2> site{};
    for (std::size_t d = 0; d < 2; ++d) {
      const auto e = static_cast<Eigen::Index>(d);
      site[d] = std::clamp(static_cast<Index>(std::floor((x[e] - box.lower[e]) / lattice.dx)), Index{0},
                           lattice.count[d] - 1);
    }
    const Index row = part.row(site) - part.first_row();
    if (row >= 0 && row < static_cast<Index>(part.sites().size())) owned_.push_back(node);
  }
}

Vector<2> PatchGrid::point(Index node) const
{
  const geom::Box<2>& box = around_.shape().box;
  const std::array<Index, 2> at{node % (cells_[0] + 1), node / (cells_[0] + 1)};
  Vector<2> x;
  for (std::size_t d = 0; d < 2; ++d) {
    const auto e = static_cast<Eigen::Index>(d);
    x[e] = at[d] == cells_[d] ? box.upper[e] : box.lower[e] + at[d] * size_[e];
  }
  return x;
}

Host PatchGrid::host(Index node, const Vector<2>& x) const
{
  const Vector<2> at = point(node);
  return *around_.edge_host(at, x - at);
}

std::array<Index, 4> PatchGrid::corners(Index cell) const
{
  const Index first = cell / cells_[0] * (cells_[0] + 1) + cell % cells_[0], above = first + cells_[0] + 1;
  return {first, first + 1, above + 1, above};
}

Index PatchGrid::column_of(Index site, std::size_t d) const
{
  const double x = (site + 0.5) * part_.lattice().dx / size_[static_cast<Eigen::Index>(d)];
  return std::clamp(static_cast<Index>(std::floor(x + 1e-9)), Index{0}, cells_[d] - 1);
}

Index PatchGrid::cell_of(const Site<2>& site) const
{
  return column_of(site[1], 1) * cells_[0] + column_of(site[0], 0);
}

std::pair<Site<2>, Site<2>> PatchGrid::sites(Index cell) const
{
  const std::array<Index, 2> at{cell % cells_[0], cell / cells_[0]};
  Site<2> lower{}, upper{};
  for (std::size_t d = 0; d < 2; ++d) {
    const double ratio = size_[static_cast<Eigen::Index>(d)] / part_.lattice().dx;
    const auto first = [&](Index column) {
      auto site = std::max(Index{0}, static_cast<Index>(std::floor(column * ratio)) - 2);
      while (site < part_.lattice().count[d] && column_of(site, d) < column) ++site;
      return site;
    };
    lower[d] = first(at[d]);
    upper[d] = at[d] + 1 == cells_[d] ? part_.lattice().count[d] : first(at[d] + 1);
  }
  return {lower, upper};
}

std::array<double, 4> PatchGrid::weights(Index cell, const Vector<2>& x) const
{
  const Vector<2> t = (x - point(corners(cell)[0])).array() / size_.array();
  return {(1.0 - t[0]) * (1.0 - t[1]), t[0] * (1.0 - t[1]), t[0] * t[1], (1.0 - t[0]) * t[1]};
}
} // namespace pdx::couple
