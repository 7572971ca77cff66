#include "gmsh_scan.hpp"
#include "pdx/base/error.hpp"
#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>

namespace pdx::mesh {
namespace gmsh_border {
/// Physical tags of a name; a name may stand for several.
std::set<std::int64_t> surfaces_of(const GmshSource& source, const GmshFile& file, const std::string& region)
{
  std::set<std::int64_t> tags;
  std::set<std::string> names;
  for (const auto& [tag, name] : file.surface_names) {
    names.insert(name);
    if (name == region) tags.insert(tag);
  }
  if (tags.empty())
    throw UserError(fmt::format("{} has no physical surface \"{}\": it has {}", source.name(), region,
                                names.empty() ? "none with a name" : fmt::format("{}", fmt::join(names, ", "))));
  return tags;
}

/// Corners of the chosen cells, each cell once.
std::vector<std::vector<std::size_t>> cells_of(const GmshSource& source, const GmshFile& file,
                                               const std::string& region)
{
  const std::set<std::int64_t> tags = region.empty() ? std::set<std::int64_t>() : surfaces_of(source, file, region);
  std::set<std::array<std::size_t, 4>> known;
  std::vector<std::vector<std::size_t>> cells;
  for (const GmshFile::Cell& cell : file.cells) {
    const auto in = [&](std::int64_t tag) { return file.is_in(cell, tag); };
    if (!region.empty() && std::ranges::none_of(tags, in)) continue;
    auto sorted = cell.nodes;
    std::ranges::sort(sorted);
    if (!known.insert(sorted).second) continue;
    cells.emplace_back(cell.nodes.begin(), cell.nodes.end() - (cell.nodes[3] == cell.nodes[2]));
  }
  return cells;
}
} // namespace gmsh_border

std::vector<std::array<Vector<2>, 2>> read_gmsh_border(const std::string& option, const std::string& file,
                                                       const std::string& region)
{
  GmshSource source(file, option);
  const GmshFile content = scan_gmsh(source, GmshCells::any);
  std::map<std::pair<std::size_t, std::size_t>, int> cells_at; // of each edge
  constexpr double far = std::numeric_limits<double>::infinity();
  Vector<3> lower = Vector<3>::Constant(far), upper = -lower;
  for (const std::vector<std::size_t>& corners : gmsh_border::cells_of(source, content, region))
    for (std::size_t k = 0; k < corners.size(); ++k) {
      ++cells_at[std::minmax(corners[k], corners[(k + 1) % corners.size()])];
      lower = lower.cwiseMin(content.nodes[corners[k]].x).eval();
      upper = upper.cwiseMax(content.nodes[corners[k]].x).eval();
    }
  if (cells_at.empty())
    throw UserError(fmt::format("{} has no cells of three or four nodes{}: mesh the surface and save its elements",
                                source.name(), region.empty() ? "" : " in physical surface \"" + region + "\""));
  if (upper[2] - lower[2] > 1e-9 * (upper - lower).head<2>().maxCoeff())
    throw UserError(fmt::format("{}: z runs from {} to {} m: the mesh must lie in one plane z = constant",
                                source.name(), lower[2], upper[2]));
  std::vector<std::array<Vector<2>, 2>> border;
  for (const auto& [edge, cells] : cells_at) {
    const auto [a, b] = edge;
    if (cells > 2)
      throw UserError(fmt::format("{}: {} cells share the edge from ({:g}, {:g}) to ({:g}, {:g}): remove duplicate "
                                  "surfaces and folds",
                                  source.name(), cells, content.nodes[a].x[0], content.nodes[a].x[1],
                                  content.nodes[b].x[0], content.nodes[b].x[1]));
    if (cells == 1) border.push_back({content.nodes[a].x.head<2>(), content.nodes[b].x.head<2>()});
  }
  return border;
}
} // namespace pdx::mesh
