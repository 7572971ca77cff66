#include "pdx/scene/patches.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/mesh/sites.hpp"

#include "joined_boxes.hpp"
#include "pdx/scene/kept.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

namespace pdx::scene {
namespace {
constexpr double kCoarseCells = 4.0; // background cells of peridynamics-only scenes, in spacings

/// The body grown by the layers of a horizon that boundary conditions ask for.
geom::Box<2> with_layers(const options::SceneOptions& options, geom::Box<2> box, double dx)
{
  const double width = std::floor(options.pd.horizon_ratio + 1e-9) * dx;
  for (const options::BoundaryCondition& c : options.conditions) {
    if (!c.layer) continue;
    if (c.on == "left")
      box.lower[0] = options.mesh.box.lower[0] - width;
    else if (c.on == "bottom")
      box.lower[1] = options.mesh.box.lower[1] - width;
    else if (c.on == "right")
      box.upper[0] = options.mesh.box.upper[0] + width;
    else if (c.on == "top")
      box.upper[1] = options.mesh.box.upper[1] + width;
    else
      throw UserError(
          fmt::format("-bc_{}_on is {}: a layer lies outside one of left, right, bottom, top", c.name, c.on));
  }
  return box;
}

double area_of(const std::array<Vector<2>, 4>& corners) ///< [m^2]
{
  const Vector<2> a = corners[2] - corners[0], b = corners[3] - corners[1];
  return 0.5 * std::abs(a[0] * b[1] - a[1] * b[0]);
}

/// Elements take tension over where it is; particles alone bend right.
template <class Weights, int Dim>
std::optional<Weights> weights_of(const options::PdOptions& pd, const pd::Stencil<Dim>& stencil, bool alone)
{
  using Aim = typename Weights::Aim;
  const bool demanded = pd.surface_correction == options::SurfaceCorrection::exact;
  if (!demanded && pd.surface_correction != options::SurfaceCorrection::automatic) return std::nullopt;
  auto weights = Weights::solve(stencil, alone ? Aim::bending : Aim::traction);
  if (!weights && demanded)
    throw UserError(fmt::format("-pd_surface_correction is exact: bonds of -pd_horizon_ratio {} are too few for it; "
                                "take a ratio of 3 to 6, or volume",
                                pd.horizon_ratio));
  return weights;
}
} // namespace

std::optional<pd::SolidSides> solid_sides(const options::PdOptions& pd, const pd::Stencil<3>& stencil, bool alone)
{
  return weights_of<pd::SolidSides>(pd, stencil, alone);
}

template <int Dim> geom::Lattice<Dim> lattice_in(const geom::Box<Dim>& box, double dx)
{
  const Vector<Dim> sides = box.size(), counts = sides / dx;
  geom::Lattice<Dim> lattice;
  lattice.origin = box.lower;
  for (std::size_t d = 0; d < Dim; ++d) {
    const double n = counts[static_cast<Eigen::Index>(d)];
    if (std::abs(n - std::round(n)) > kFits || std::round(n) < 1.0) {
      const double fit = nearest_fit({sides.data(), Dim}, dx);
      throw UserError(fmt::format(
          "-pd_spacing is {}: the sides {} m of the {} must be whole numbers of it; {}", dx,
          fmt::join(sides.data(), sides.data() + Dim, Dim == 2 ? " and " : ", "), Dim == 2 ? "patch" : "solid",
          fit > 0.0 ? fmt::format("the nearest that fits is {:.10g}", fit)
                    : fmt::format("no spacing fits {}: change the {}", Dim == 2 ? "both" : "all",
                                  Dim == 2 ? "patch" : "body or -material_thickness")));
    }
    lattice.count[d] = static_cast<Index>(std::round(n));
  }
  lattice.dx = sides[0] / lattice.count[0];
  if (lattice.total() > std::numeric_limits<Index>::max() / 2)
    throw UserError(fmt::format("-pd_spacing is {}: makes {} particles in one patch, more than the {} it can number",
                                dx, lattice.total(), std::numeric_limits<Index>::max() / 2));
  return lattice;
}
template geom::Lattice<2> lattice_in<2>(const geom::Box<2>&, double);
template geom::Lattice<3> lattice_in<3>(const geom::Box<3>&, double);

std::array<Index, 2> background_cells(const geom::Lattice<2>& lattice)
{
  std::array<Index, 2> cells{};
  for (std::size_t d = 0; d < 2; ++d)
    cells[d] = std::max(1, static_cast<Index>(std::round(lattice.count[d] / kCoarseCells)));
  return cells;
}

namespace {
/// Shapes, entries and body. @param mesh its box grows by layers
void lay_shapes(const options::SceneOptions& options, mesh::MeshOptions& mesh, PatchPlan& plan)
{
  plan.body = mesh.box;
  if (options.pd.everywhere) {
    (void)lattice_in<2>(mesh.box, options.pd.spacing[0]); // the body itself must fit
    mesh.box = with_layers(options, mesh.box, options.pd.spacing[0]);
    plan.shapes.push_back(couple::PatchShape::of_box(mesh.box, lattice_in<2>(mesh.box, options.pd.spacing[0])));
    plan.entries.push_back({0});
  } else {
    plan.entries = patches_of_boxes(options);
    for (const std::vector<std::size_t>& entries : plan.entries) plan.shapes.push_back(join_boxes(options, entries));
  }
  name_sites(plan.shapes, plan.body, options.pd.anchors);
}
} // namespace

std::vector<couple::PatchShape> patch_shapes(const options::SceneOptions& options)
{
  mesh::MeshOptions mesh = options.mesh;
  PatchPlan plan;
  lay_shapes(options, mesh, plan);
  return std::move(plan.shapes);
}

/// Sites that follow each other in a run have names that do.
void add_names(const couple::PatchShape& shape, std::span<const Index> sites, std::vector<field::RowName>& names)
{
  const auto step = static_cast<std::uint64_t>(shape.names.lattices); // from one name of a run to the next
  for (std::size_t k = 0; k < sites.size();) {
    const Site<2> at = shape.active.site(sites[k]);
    const std::uint64_t first = shape.names.of(at);
    const auto run = static_cast<std::uint64_t>(shape.active.end_of_run(at) - at[0]);
    const Index from = sites[k];
    for (std::uint64_t j = 0; j < run && k < sites.size() && sites[k] == from + static_cast<Index>(j); ++j, ++k)
      names.push_back(field::RowName::particle(first + j * step));
  }
}

PatchPlan plan_patches(const options::SceneOptions& options, mesh::MeshOptions& mesh, const PatchPlan* known)
{
  PatchPlan plan;
  lay_shapes(options, mesh, plan);
  const auto take_of = [&plan](const PatchPlan& other, double dx) {
    const auto found = std::ranges::find(other.stencils, dx, &pd::Stencil<2>::dx) - other.stencils.begin();
    if (found == std::ssize(other.stencils)) return false;
    const auto sides = other.sides[static_cast<std::size_t>(found)];
    const pd::Stencil<2> stencil = other.stencils[static_cast<std::size_t>(found)];
    plan.stencils.push_back(stencil);
    plan.sides.push_back(sides);
    return true;
  };
  for (const couple::PatchShape& shape : plan.shapes) {
    const double dx = shape.lattice.dx;
    if ((known && take_of(*known, dx)) || take_of(plan, dx)) continue;
    try {
      plan.stencils.push_back(pd::make_stencil<2>({dx, options.elastic.thickness, options.pd.horizon_ratio * dx,
                                                   options.pd.micromodulus, options.pd.calibration, options.elastic}));
      pd::require_bond_words(plan.stencils.back());
    } catch (const UserError& wrong) {
      throw UserError(fmt::format("-pd_horizon_ratio is {}: {}", options.pd.horizon_ratio, wrong.what()));
    }
    plan.sides.push_back(weights_of<pd::SideWeights>(options.pd, plan.stencils.back(), options.pd.everywhere));
  }
  if (options.pd.everywhere && mesh.cells[0] == 0) mesh.cells = background_cells(plan.shapes[0].lattice);
  return plan;
}

mesh::CellCost cell_cost(const PatchPlan& plan)
{
  constexpr int kCoarse = 3, kElement = 1; // in particles; from the static solver's phases
  return [shapes = plan.shapes](const std::array<Vector<2>, 4>& corners) {
    const Vector<2> centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    const double area = area_of(corners);
    for (const auto& shape : shapes)
      if (shape.holds(centre))
        return kCoarse + static_cast<int>(std::round(area / (shape.lattice.dx * shape.lattice.dx)));
    return kCoarse + kElement;
  };
}

namespace {
/// The box among those of a patch that is at fault where not whole cells were covered.
class CutBoxes {
public:
  CutBoxes(const couple::PatchShape& shape, const mesh::Mesh& mesh)
      : boxes_(shape.boxes), near_(kFits * shape.lattice.dx), area_(boxes_.size(), 0.0), cut_(boxes_.size(), 0.0)
  {
    for (Index c = 0; c < mesh.owned_cells(); ++c)
      for (std::size_t b = 0; b < boxes_.size() && mesh.body(c) == shape.body; ++b) {
        const auto corners = mesh.corners(c);
        Vector<2> lower = corners[0], upper = corners[0];
        for (const Vector<2>& x : corners) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
        const Vector<2> shared = upper.cwiseMin(boxes_[b].upper) - lower.cwiseMax(boxes_[b].lower);
        if (shared.minCoeff() <= near_) continue;
        if (boxes_[b].contains(lower, near_) && boxes_[b].contains(upper, near_))
          area_[b] += area_of(corners);
        else
          cut_[b] = 1.0; // whichever side of the box its middle is on
      }
    MPI_Allreduce(MPI_IN_PLACE, area_.data(), static_cast<int>(area_.size()), MPI_DOUBLE, MPI_SUM, mesh.comm());
    MPI_Allreduce(MPI_IN_PLACE, cut_.data(), static_cast<int>(cut_.size()), MPI_DOUBLE, MPI_MAX, mesh.comm());
  }
  std::size_t first() const
  {
    for (std::size_t b = 0; b < boxes_.size(); ++b)
      if (cut_[b] > 0.0 || std::abs(area_[b] - boxes_[b].size().prod()) >= 1e-6 * boxes_[b].size().prod()) return b;
    return 0;
  }
  bool cuts(std::size_t box) const { return cut_[box] > 0.0; }
  double share(std::size_t box) const { return area_[box] / boxes_[box].size().prod(); } ///< that has elements [-]

private:
  std::span<const geom::Box<2>> boxes_;
  double near_;
  std::vector<double> area_, cut_;
};

std::string nearest_box(const geom::Box<2>& box, const mesh::MeshOptions& options, const geom::Frame& frame)
{
  if (!options.file.empty()) return "";
  const Vector<2> h = options.box.size().array() / Eigen::Array2d(options.cells[0], options.cells[1]);
  const auto snap = [&](const Vector<2>& x) {
    const Eigen::Array2d cells = ((x - options.box.lower).array() / h.array()).round();
    return Vector<2>(options.box.lower.array() + cells * h.array());
  };
  const Vector<2> lower = frame.given<2>(snap(box.lower)), upper = frame.given<2>(snap(box.upper));
  return fmt::format(", e.g. {:.10g},{:.10g},{:.10g},{:.10g}", lower[0], lower[1], upper[0], upper[1]);
}
} // namespace

std::vector<Index> cells_under(const mesh::Mesh& mesh, const couple::PatchShape& shape)
{
  std::vector<Index> cells;
  for (const geom::Box<2>& box : shape.boxes) {
    const std::vector<Index> more = mesh.finder().in(box);
    cells.insert(cells.end(), more.begin(), more.end());
  }
  std::erase_if(cells, [&](Index c) { return mesh.body(c) != shape.body; }); // those of others may stick out of them
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

namespace {
/// Have cells of another body their middle in a patch? Collective.
bool in_two_bodies(const mesh::Mesh& mesh, const couple::PatchShape& shape)
{
  return any_rank(mesh.comm(), std::ranges::any_of(shape.boxes, [&](const geom::Box<2>& box) {
                    return std::ranges::any_of(mesh.finder().in(box),
                                               [&](Index c) { return mesh.body(c) != shape.body; });
                  }));
}
} // namespace

void cover_cells(mesh::Mesh& mesh, const PatchPlan& plan, const mesh::MeshOptions& options, const geom::Frame& frame,
                 Kept* kept)
{
  std::vector<double> area(plan.shapes.size(), 0.0), cut(plan.shapes.size(), 0.0);
  for (std::size_t p = 0; p < plan.shapes.size(); ++p) {
    const couple::PatchShape& shape = plan.shapes[p];
    if (kept && kept->has(p)) continue;
    for (const Index c : cells_under(mesh, shape)) {
      if (kept) kept->note(c, mesh.use(c));
      mesh.cover(c, static_cast<int>(p));
      if (c >= mesh.owned_cells()) continue;
      const auto corners = mesh.corners(c);
      area[p] += area_of(corners);
      for (const Vector<2>& x : corners)
        if (!shape.holds(x, kFits * shape.lattice.dx)) cut[p] = 1.0;
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, area.data(), static_cast<int>(area.size()), MPI_DOUBLE, MPI_SUM, mesh.comm());
  MPI_Allreduce(MPI_IN_PLACE, cut.data(), static_cast<int>(cut.size()), MPI_DOUBLE, MPI_MAX, mesh.comm());
  for (std::size_t p = 0; p < plan.shapes.size(); ++p) {
    const couple::PatchShape& shape = plan.shapes[p];
    const auto which = [&](std::size_t b) {
      return fmt::format("-pd_patches: patch {} {} to {}", plan.entries[p][b] + 1, frame.text(shape.boxes[b].lower),
                         frame.text(shape.boxes[b].upper));
    };
    for (std::size_t b = 0; b < shape.boxes.size(); ++b)
      if (!mesh.bounds().contains(shape.boxes[b].lower, kFits * shape.lattice.dx) ||
          !mesh.bounds().contains(shape.boxes[b].upper, kFits * shape.lattice.dx))
        throw UserError(fmt::format("{} leaves the mesh, which spans {} to {}", which(b),
                                    frame.text(mesh.bounds().lower), frame.text(mesh.bounds().upper)));
    const double whole = static_cast<double>(shape.active.size()) * shape.lattice.dx * shape.lattice.dx;
    if (kept && kept->has(p)) continue;
    if (cut[p] == 0.0 && std::abs(area[p] - whole) < 1e-6 * whole) continue;
    const CutBoxes boxes(shape, mesh);
    const std::size_t b = boxes.first();
    if (!boxes.cuts(b) && in_two_bodies(mesh, shape))
      throw UserError(
          fmt::format("-pd_patches: the patch from {} to {} lies in two bodies, which bonds would join: give a "
                      "box for each (-adapt_seed tip: put the tip farther from the other body)",
                      frame.text(shape.box.lower), frame.text(shape.box.upper)));
    if (!boxes.cuts(b))
      throw UserError(fmt::format("{} reaches where there are no elements: only {:.3g} % of it lies in the body; put "
                                  "several boxes side by side, each in the body",
                                  which(b), 100.0 * boxes.share(b)));
    throw UserError(fmt::format("{} cuts elements: its sides must lie on element boundaries{}", which(b),
                                nearest_box(shape.boxes[b], options, frame)));
  }
}

namespace {
/// Sites of a patch that follow each other along x in one cell.
struct SitesInCell {
  Index patch, place, count, cell;
  Site<2> first;
};

/// But for patches that are kept.
std::vector<SitesInCell> sites_in_cells(const mesh::Mesh& mesh, const PatchPlan& plan, const Kept* kept)
{
  std::vector<SitesInCell> mine;
  for (const Index c : mesh.cells(mesh::Use::covered)) {
    if (c >= mesh.owned_cells() || (kept && kept->has(static_cast<std::size_t>(mesh.patch(c))))) continue;
    const couple::PatchShape& shape = plan.shapes[static_cast<std::size_t>(mesh.patch(c))];
    const std::size_t before = mine.size();
    mesh::for_each_site(mesh, c, shape.lattice, 0, [&](const Site<2>& site, const Vector<2>&) {
      if (!shape.active.has(site)) return;
      if (mine.size() > before && mine.back().first[1] == site[1] &&
          mine.back().first[0] + mine.back().count == site[0])
        ++mine.back().count;
      else
        mine.push_back({mesh.patch(c), static_cast<Index>(shape.active.place(site)), 1, c, site});
    });
  }
  std::ranges::sort(mine, {}, [](const SitesInCell& sites) { return std::pair{sites.patch, sites.place}; });
  return mine;
}
} // namespace

std::vector<pd::Particle> make_particles(const mesh::Mesh& mesh, const PatchPlan& plan, Kept* kept)
{
  std::vector<pd::Particle> mine;
  for (const SitesInCell& sites : sites_in_cells(mesh, plan, kept)) {
    const geom::Lattice<2>& lattice = plan.shapes[static_cast<std::size_t>(sites.patch)].lattice;
    for (Index k = 0; k < sites.count; ++k)
      mine.push_back({sites.patch, sites.place + k, sites.cell, lattice.point({sites.first[0] + k, sites.first[1]})});
  }
  if (kept) mine = kept->particles(mine, plan.shapes.size());
  std::int64_t total = static_cast<std::int64_t>(mine.size()), wanted = 0;
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, mesh.comm());
  for (const auto& shape : plan.shapes) wanted += shape.active.size();
  if (total != wanted) throw std::logic_error(fmt::format("{} particles found a cell, {} should have", total, wanted));
  return mine;
}
} // namespace pdx::scene
