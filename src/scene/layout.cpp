#include "pdx/scene/layout.hpp"

#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/box_cover.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::scene {
namespace {
constexpr double kSameSide = 1e-6;                  // of a spacing: sides as near are one
constexpr const char* kPatches = "/layout_patches"; // spacing, lower and upper corner of each box [m]
constexpr const char* kCells = "/layout_cells";     // in space: body, then place in its grid
constexpr const char* kCracks = "/layout_cracks";   // number of the crack and a point of it [m]

std::vector<double> table(const io::SealedReader& file, const char* name, int columns)
{
  std::vector<double> values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(file.shape(name)[0]));
  file.read(name, 0, columns, std::span<double>(values));
  return values;
}

std::string fault_of_box(const double* row)
{
  if (!(row[0] > 0.0)) return fmt::format("has a spacing of {:g} m", row[0]);
  return row[1] < row[3] && row[2] < row[4] ? "" : "has a box without inside";
}
bool same_patches(const Layout& a, const Layout& b)
{
  const auto same = [](const geom::Box<2>& p, const geom::Box<2>& q) {
    return p.lower == q.lower && p.upper == q.upper;
  };
  return a.spacing == b.spacing && std::ranges::equal(a.patches, b.patches, same);
}

/// Are the lines those given and what grew from their tips, and behind them what began or branched off later?
bool are_grown(const std::vector<crack::Polyline>& lines, const crack::CrackSet& given)
{
  if (lines.size() < static_cast<std::size_t>(given.size())) return false;
  const auto grows = [&given](int crack, bool last) {
    return std::ranges::any_of(given.tips(),
                               [&](const crack::Tip& tip) { return tip.crack == crack && tip.last == last; });
  };
  for (int k = 0; k < given.size(); ++k) {
    const crack::Polyline& line = lines[static_cast<std::size_t>(k)];
    const auto& start = given.points(k);
    const auto known = std::search(line.begin(), line.end(), start.begin(), start.end());
    if (known == line.end() || (known != line.begin() && !grows(k, false)) ||
        (line.end() - known != std::ssize(start) && !grows(k, true)))
      return false;
  }
  return true;
}

/// Throws UserError for what no cell of a body can be; which cells there are, those who build know.
std::vector<mpm::GridPlace<3>> cells_in(const io::SealedReader& file, const options::SceneOptions& options)
{
  const std::vector<double> places = table(file, kCells, 4);
  std::vector<mpm::GridPlace<3>> cells;
  for (std::size_t k = 0; k < places.size(); k += 4) {
    for (std::size_t i = 0; i < 4; ++i)
      file.require(kCells,
                   places[k + i] >= 0.0 && places[k + i] < 2147483647.0 && places[k + i] == std::floor(places[k + i])
                       ? ""
                       : fmt::format("has {}: must be a whole number from 0 on", places[k + i]));
    const auto at = [&](std::size_t i) { return static_cast<Index>(places[k + i]); };
    cells.push_back({at(0), {at(1), at(2), at(3)}});
    file.require(kCells, static_cast<std::size_t>(at(0)) < options.points.bodies.size()
                             ? ""
                             : fmt::format("has the body {} of {}", at(0) + 1, options.points.bodies.size()));
  }
  const bool rising = std::ranges::adjacent_find(cells, std::greater_equal<>()) == cells.end();
  file.require(kCells, rising ? "" : "is not in order");
  return cells;
}
} // namespace

std::vector<geom::LatticeAnchor> body_lattices(const options::SceneOptions& options)
{
  std::vector<geom::LatticeAnchor> lattices;
  const auto add = [&](const geom::Box<2>& body) { lattices.push_back({body.lower, options.pd.spacing[0]}); };
  if (options.points.regions.empty()) add(options.mesh.box);
  for (const geom::Box<2>& body : options.points.regions) add(body);
  return lattices;
}

Layout Layout::given(const options::SceneOptions& options)
{
  Layout layout{options.pd.patches, {}, options.cracks.lines, {}, options.points.regions, {}};
  if (options.mixed_in_space()) {
    layout.cells = options.pd.cells;
    return layout;
  }
  for (std::size_t p = 0; p < layout.patches.size(); ++p) {
    layout.spacing.push_back(options.pd.spacing_of(p));
    layout.anchors.push_back({layout.patches[p].lower, layout.spacing[p]});
  }
  if (options.converts()) // where bodies have no patch yet
    for (const geom::LatticeAnchor& anchor : body_lattices(options)) layout.anchors.push_back(anchor);
  return layout;
}

options::SceneOptions Layout::in(options::SceneOptions options) const
{
  if (!patches.empty() || options.converts()) { // all that bulk became may be bulk again
    options.pd.patches = patches;
    if (!patches.empty()) options.pd.spacing = spacing;
    options.pd.anchors = anchors;
  }
  options.cracks.lines = cracks;
  if (cells) options.pd.cells = *cells;
  return options;
}

Layout Layout::changed(const adapt::LayoutChange& change) const
{
  struct Family {
    geom::LatticeAnchor lattice;
    Index body;
    bool operator==(const Family& other) const
    {
      return body == other.body && geom::same_lattice(lattice, other.lattice);
    }
  };
  std::vector<Family> families; // in order of patches
  std::vector<std::vector<geom::Box<2>>> boxes;
  const auto of = [&](const geom::Box<2>& box, double dx) -> std::vector<geom::Box<2>>& {
    const Family family{{box.lower, dx}, geom::holder(regions, box)};
    const auto known = std::ranges::find(families, family);
    if (known != families.end()) return boxes[static_cast<std::size_t>(known - families.begin())];
    families.push_back(family);
    return boxes.emplace_back();
  };
  for (std::size_t p = 0; p < patches.size(); ++p) {
    std::vector<geom::Box<2>> left{patches[p]};
    for (const geom::Box<2>& hole : change.uncover) {
      std::vector<geom::Box<2>> rest;
      for (const geom::Box<2>& box : left)
        for (const geom::Box<2>& piece : geom::without(box, hole, kSameSide * spacing[p])) rest.push_back(piece);
      left = std::move(rest);
    }
    auto& all = of(patches[p], spacing[p]);
    all.insert(all.end(), left.begin(), left.end());
  }
  for (const adapt::LayoutChange::Cover& cover : change.cover) of(cover.box, cover.spacing).push_back(cover.box);
  Layout next{{}, {}, change.cracks.value_or(cracks), anchors, regions, {}};
  if (cells) std::ranges::set_union(*cells, change.cells, std::back_inserter(next.cells.emplace()));
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (const geom::Box<2>& box : geom::joined(std::move(boxes[k]), kSameSide * families[k].lattice.spacing)) {
      next.patches.push_back(box);
      next.spacing.push_back(families[k].lattice.spacing);
    }
  return next;
}

void Layout::write(io::Hdf5File& file) const
{
  int rank = 0;
  MPI_Comm_rank(file.comm(), &rank);
  std::vector<double> boxes, points;
  for (std::size_t p = 0; p < patches.size() && rank == 0; ++p)
    boxes.insert(boxes.end(),
                 {spacing[p], patches[p].lower[0], patches[p].lower[1], patches[p].upper[0], patches[p].upper[1]});
  for (std::size_t k = 0; k < cracks.size() && rank == 0; ++k)
    for (const Vector<2>& x : cracks[k]) points.insert(points.end(), {static_cast<double>(k), x[0], x[1]});
  file.dataset(kPatches, std::span<const double>(boxes), 5);
  file.dataset(kCracks, std::span<const double>(points), 3);
  if (!cells) return;
  std::vector<double> places;
  for (const mpm::GridPlace<3>& cell : *cells)
    if (rank == 0)
      for (const Index k : {cell.body, cell.at[0], cell.at[1], cell.at[2]}) places.push_back(k);
  file.dataset(kCells, std::span<const double>(places), 4);
}

Layout Layout::read(const io::SealedReader& file, const options::SceneOptions& options)
{
  const Layout given = Layout::given(options);
  const bool patches_move = options.layout.patches_move();
  Layout layout;
  layout.anchors = given.anchors;
  layout.regions = given.regions;
  const std::vector<double> boxes = table(file, kPatches, 5), points = table(file, kCracks, 3);
  for (std::size_t k = 0; k < boxes.size(); k += 5) {
    const double* row = boxes.data() + k;
    file.require(kPatches, fault_of_box(row));
    layout.spacing.push_back(row[0]);
    layout.patches.push_back({{row[1], row[2]}, {row[3], row[4]}});
  }
  for (std::size_t k = 0; k < points.size(); k += 3) {
    const auto cracks = static_cast<double>(layout.cracks.size());
    file.require(kCracks, points[k] == cracks || (cracks > 0.0 && points[k] == cracks - 1.0)
                              ? ""
                              : fmt::format("has crack {} behind {}", points[k], cracks));
    layout.cracks.resize(static_cast<std::size_t>(points[k]) + 1);
    layout.cracks.back().push_back({points[k + 1], points[k + 2]});
  }
  if (given.cells) {
    layout.cells = cells_in(file, options);
    file.require(kCells, patches_move || layout.cells == given.cells ? "" : "is not where particles of this scene lie");
  }
  file.require(kPatches,
               patches_move || same_patches(layout, given) ? "" : "is not where the patches of this scene lie");
  const bool same = layout.cracks == given.cracks;
  const bool grown = !same && patches_move && are_grown(layout.cracks, {given.cracks, options.mesh.box});
  file.require(kCracks, same || grown ? "" : "is not where the cracks of this scene run");
  return layout;
}
} // namespace pdx::scene
