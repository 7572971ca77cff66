#include "pdx/scene/settle.hpp"

#include "pdx/mesh/gmsh.hpp"
#include "pdx/options/adapt_options.hpp"
#include "pdx/scene/seeds.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::scene {
namespace {
constexpr double kCoarsest = 1e-3; // of the smallest length that matters: step of the grid
constexpr double kInZone = 1e-6;   // likewise: what is as far outside a zone is on its border
constexpr double kSameLine = 2.0;  // steps of the grid

void require_resolved(const geom::Frame& frame, double finest)
{
  if (frame.step() <= kCoarsest * finest) return;
  throw UserError(fmt::format("the body has its corner at {}, where coordinates are told apart to {:g} m: too coarse "
                              "for spacings, particles or "
                              "elements of {:g} m; move all of the scene nearer to the origin",
                              frame.text({0.0, 0.0}), frame.step(), finest));
}

/// The smallest spacing, else the smallest side of an element [m].
double finest_of(const options::SceneOptions& options, double shortest_edge)
{
  if (!options.pd.spacing.empty()) return std::min(shortest_edge, *std::ranges::min_element(options.pd.spacing));
  return options.pd.seeded ? options::kSeedShare * shortest_edge : shortest_edge;
}

/// The nearest of the lines `distance` apart, if it is as near as two roundings leave it.
void snap(double& x, double first, double distance, double step)
{
  const double line = first + distance * std::round((x - first) / distance);
  if (std::abs(line - x) <= kSameLine * step) x = line;
}

/// A crack that runs or ends on the border of the body, on the lines of a mesh, or between or on rows of particles does
/// so exactly, also where these are no decimals.
void snap_cracks(options::SceneOptions& options)
{
  const mesh::MeshOptions& mesh = options.mesh;
  const double step = options.frame.step();
  std::vector<std::pair<geom::Box<2>, double>> grids{{mesh.box, 0.0}}; // and spacing; 0: borders only
  for (std::size_t p = 0; p < options.pd.patches.size(); ++p)
    grids.emplace_back(options.pd.patches[p], options.pd.spacing_of(p));
  if (options.pd.everywhere) grids[0].second = options.pd.spacing[0];
  for (crack::Polyline& line : options.cracks.lines)
    for (Vector<2>& x : line)
      for (Eigen::Index d = 0; d < 2; ++d) {
        const auto cells = static_cast<double>(mesh.cells[static_cast<std::size_t>(d)]);
        if (mesh.file.empty() && cells > 0.0) snap(x[d], mesh.box.lower[d], mesh.box.size()[d] / cells, step);
        for (const auto& [box, spacing] : grids) {
          const double side = box.size()[d], halves = spacing > 0.0 ? std::round(2.0 * side / spacing) : 1.0;
          if (box.contains(x, kSameLine * step) && halves >= 1.0) snap(x[d], box.lower[d], side / halves, step);
        }
      }
}

/// Likewise sides of patches on the lines of a box mesh.
void snap_patches(options::SceneOptions& options)
{
  const mesh::MeshOptions& mesh = options.mesh;
  if (!mesh.file.empty() || mesh.cells[0] < 1) return;
  const Vector<2> h = mesh.box.size().array() / Eigen::Array2d(mesh.cells[0], mesh.cells[1]);
  for (geom::Box<2>& patch : options.pd.patches)
    for (Eigen::Index d = 0; d < 2; ++d) {
      snap(patch.lower[d], mesh.box.lower[d], h[d], options.frame.step());
      snap(patch.upper[d], mesh.box.lower[d], h[d], options.frame.step());
    }
}
} // namespace

void move_into(const geom::Frame& frame, double finest, options::SceneOptions& options)
{
  require_resolved(frame, finest);
  options.frame = frame;
  const auto move = [&frame](auto& place) { place = frame.inside(place); };
  move(options.mesh.box);
  if (options.layout.renew_box) move(*options.layout.renew_box);
  if (options.mesh.list) std::ranges::for_each(options.mesh.list->points, move);
  std::ranges::for_each(options.pd.patches, move);
  for (geom::Box<3>& box : options.pd.boxes) box = {frame.inside(box.lower), frame.inside(box.upper)};
  for (crack::Polyline& line : options.cracks.lines) std::ranges::for_each(line, move);
  std::ranges::for_each(options.fracture.no_fail, move);
  for (geom::Box<2>& zone : options.fracture.no_fail) {
    zone.lower.array() -= kInZone * finest;
    zone.upper.array() += kInZone * finest;
  }
  for (options::BoundaryCondition& c : options.conditions) {
    if (c.box) move(*c.box);
    if (c.at) move(*c.at);
  }
  if (options.post.j_centre) move(*options.post.j_centre);
  options.regions = options.region_set.settled(frame, options.elastic, options.fracture);
  snap_patches(options);
  snap_cracks(options);
}

double read_elements(MPI_Comm comm, mesh::MeshOptions& mesh)
{
  if (!mesh.file.empty()) return mesh::load(comm, mesh);
  if (mesh.cells[0] < 1) return std::numeric_limits<double>::infinity();
  return std::min(mesh.box.size()[0] / mesh.cells[0], mesh.box.size()[1] / mesh.cells[1]);
}

void settle(MPI_Comm comm, options::SceneOptions& options)
{
  if (!options.pd.cloud.empty() || options.points.any()) return; // as they are read and filled
  const auto everywhere = [](const Vector<2>&) { return true; };
  (void)crack::CrackSet(options.cracks.lines, everywhere, 1.0); // refuses crooked ones as they are given
  const double edge = read_elements(comm, options.mesh);
  move_into(geom::Frame(options.mesh.box), finest_of(options, edge), options);
  if (!options.pd.seeded) return;
  plant_seeds(comm, options);
  snap_patches(options);
  snap_cracks(options);
}
} // namespace pdx::scene
