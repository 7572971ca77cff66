#include "pdx/scene/particle_warnings.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>

namespace pdx::scene {
namespace {
constexpr double kNear = 0.1; // sizes of a particle
constexpr double kGap = 1.2;  // likewise: a bond's middle is as far from any particle

template <int Dim> Vector<Dim> place(const pd::CsrView<Dim>& view, std::size_t k)
{
  return Eigen::Map<const Vector<Dim>>(view.points + k * Dim);
}

/// Does a bond from particle i cross a place as wide as two particles where there is none?
template <int Dim> bool crosses_gap(const pd::CsrView<Dim>& view, std::size_t i, std::int64_t bond, double size)
{
  if (!view.intact[bond] || view.length[bond] < 2.0 * kGap * size) return false;
  const Vector<Dim> middle = 0.5 * (place(view, i) + place(view, static_cast<std::size_t>(view.neighbour[bond])));
  for (std::int64_t b = view.first[i]; b < view.first[i + 1]; ++b)
    if ((place(view, static_cast<std::size_t>(view.neighbour[b])) - middle).norm() < kGap * size) return false;
  return true;
}

/// Numbers in the file, counted from 1, of the particles of all ranks that are so; and where the first is.
struct Found {
  std::vector<Index> numbers;
  std::string first;
};

template <int Dim, class IsSo>
Found find(const options::SceneOptions& options, const CloudPart<Dim>& body, IsSo&& is_so)
{
  struct Entry {
    Index number;
    std::array<double, 3> at;
  };
  const pd::CsrView<Dim> view = body.bonds().part().view();
  std::vector<Entry> mine;
  for (std::size_t i = 0; i < body.model().particles.size(); ++i) {
    if (!is_so(view, i)) continue;
    Entry entry{body.model().particles[i].site + 1, {}};
    const Vector<Dim> x = options.frame.given<Dim>(place(view, i));
    std::copy_n(x.data(), Dim, entry.at.begin());
    mine.push_back(entry);
  }
  std::vector<Entry> all = gather_all(body.model().system.rows.comm, mine);
  std::ranges::sort(all, {}, &Entry::number);
  Found found;
  for (const Entry& entry : all) found.numbers.push_back(entry.number);
  if (!all.empty())
    found.first =
        fmt::format("{} at ({:.10g})", all[0].number, fmt::join(all[0].at.begin(), all[0].at.begin() + Dim, ", "));
  return found;
}
} // namespace

template <int Dim>
std::vector<std::string> cloud_warnings(const options::SceneOptions& options, const CloudPart<Dim>& body)
{
  const auto size = [&](std::size_t i) {
    return pd::particle_size<Dim>(body.bonds().volumes()[i], options.elastic.thickness);
  };
  const auto any_bond = [](const pd::CsrView<Dim>& view, std::size_t i, auto&& is_so) {
    for (std::int64_t b = view.first[i]; b < view.first[i + 1]; ++b)
      if (is_so(b)) return true;
    return false;
  };
  using View = pd::CsrView<Dim>;
  const Found lonely =
      find<Dim>(options, body, [](const View& view, std::size_t i) { return view.first[i] == view.first[i + 1]; });
  const Found near = find<Dim>(options, body, [&](const View& view, std::size_t i) {
    return any_bond(view, i, [&](std::int64_t b) { return view.length[b] < kNear * size(i); });
  });
  const Found apart = find<Dim>(options, body, [&](const View& view, std::size_t i) {
    return any_bond(view, i, [&](std::int64_t b) { return crosses_gap(view, i, b, size(i)); });
  });
  std::vector<std::string> lines;
  if (!lonely.numbers.empty())
    lines.push_back(
        fmt::format("-pd_cloud: {} particle(s) have no neighbour within -pd_horizon {:g} and carry nothing, "
                    "the first is number {}: take them out, or widen the horizon",
                    lonely.numbers.size(), options.pd.horizon, lonely.first));
  if (!near.numbers.empty())
    lines.push_back(
        fmt::format("-pd_cloud: {} particles have a neighbour nearer than a tenth of their size, which makes "
                    "the stable step short, the first is number {}: take doubles out",
                    near.numbers.size(), near.first));
  if (!apart.numbers.empty())
    lines.push_back(
        fmt::format("-pd_cloud: {} particles have bonds across a gap wider than two particles, the first is "
                    "number {}: bonds join all within -pd_horizon; part the sides by a crack, or move them "
                    "apart",
                    apart.numbers.size(), apart.first));
  return lines;
}

template <std::size_t Dim> void require_rows(const options::SceneOptions& options, const std::array<Index, Dim>& count)
{
  const auto thin = std::ranges::find(count, 1);
  if (thin == count.end()) return;
  throw UserError(fmt::format("-pd_spacing is {}: the body is one row of particles thick along {}, which bears nothing "
                              "across and has no right stiffness along: give a spacing that makes {} rows or more",
                              options.pd.spacing[0], "xyz"[thin - count.begin()],
                              static_cast<int>(2.0 * options.pd.horizon_ratio)));
}

namespace {
template <std::size_t Dim>
std::string warning_of(const options::SceneOptions& options, const std::array<Index, Dim>& count,
                       const std::function<std::string(int rows)>& stiffness)
{
  const auto thin = std::ranges::min_element(count);
  if (*thin >= 2.0 * options.pd.horizon_ratio - 1e-9) return {};
  return fmt::format("the body is {} rows of particles thick along {}, less than two horizons, where bonds miss their "
                     "neighbours: {}; give a smaller -pd_spacing",
                     *thin, "xyz"[thin - count.begin()], stiffness(static_cast<int>(*thin)));
}

std::string of_volumes(int)
{
  return "with -pd_surface_correction volume two rows are about twice as stiff as the material, four 1.4 times";
}
} // namespace

std::string thin_warning(const options::SceneOptions& options, const PatchPlan& plan)
{
  const auto& sides = plan.sides[0];
  const bool volume = !sides && options.pd.surface_correction != options::SurfaceCorrection::none;
  return warning_of<2>(options, plan.shapes[0].lattice.count, [&](int rows) {
    if (volume) return of_volumes(rows);
    const pd::BarStiffness bar = pd::bar_stiffness(plan.stencils[0], sides ? &*sides : nullptr, rows);
    return fmt::format("a bar of so many is {:.3g} times as stiff as the material in tension, {:.3g} times in bending",
                       bar.tension, bar.bending);
  });
}

std::string thin_warning(const options::SceneOptions& options, const std::array<Index, 3>& count,
                         const pd::Stencil<3>& stencil, const std::optional<pd::SolidSides>& sides)
{
  const bool volume = !sides && options.pd.surface_correction != options::SurfaceCorrection::none;
  return warning_of<3>(options, count, [&](int rows) {
    if (volume) return of_volumes(rows);
    std::array<Index, 3> sorted = count;
    std::ranges::sort(sorted);
    return fmt::format("a bar of {} x {} is {:.3g} times as stiff as the material in tension", sorted[0], sorted[1],
                       pd::bar_tension(stencil, sides ? &*sides : nullptr, {sorted[0], sorted[1]}));
  });
}

namespace {
std::string too_few_bonds(double ratio)
{
  return fmt::format(
      "-pd_surface_correction: bonds of -pd_horizon_ratio {} are too few for exact free sides, volume is "
      "taken, which makes thin bodies of particles too stiff; a ratio of 3 to 6 has exact ones",
      ratio);
}
} // namespace

std::string correction_warning(const options::SceneOptions& options, const std::optional<pd::SolidSides>& sides)
{
  if (options.pd.surface_correction != options::SurfaceCorrection::automatic || sides) return {};
  return too_few_bonds(options.pd.horizon_ratio);
}

std::string correction_warning(const options::SceneOptions& options, const PatchPlan& plan)
{
  if (options.pd.surface_correction != options::SurfaceCorrection::automatic || plan.sides.empty() || plan.sides[0])
    return {};
  const bool box_mesh = options.mesh.file.empty();
  const double near = 1e-6 * plan.shapes[0].lattice.dx;
  const bool inside = box_mesh && std::ranges::all_of(plan.shapes, [&](const couple::PatchShape& shape) {
                        return plan.body.contains(shape.box.lower, -near) && plan.body.contains(shape.box.upper, -near);
                      });
  if (inside && options.cracks.lines.empty()) return {}; // no free side is met
  return too_few_bonds(options.pd.horizon_ratio);
}

std::string corner_warning(const PatchPlan& plan, const geom::Box<2>& body, const geom::Frame& frame)
{
  for (std::size_t p = 0; p < plan.shapes.size(); ++p) {
    const couple::PatchShape& shape = plan.shapes[p];
    if (shape.active.is_box() || !plan.sides[p]) continue;
    const Index rows = 2 * plan.stencils[p].reach; // that a free side changes
    const std::vector<geom::StraightSide> sides = geom::straight_sides(shape.active);
    const auto free = [&](const geom::StraightSide& side) {
      const auto d = static_cast<Eigen::Index>(side.axis);
      const double face = side.upper ? body.upper[d] : body.lower[d];
      return std::abs(shape.line(side.axis, side.at) - face) < 1e-3 * shape.lattice.dx;
    };
    for (const auto& [axis, upper, at, from, to] : sides)
      for (const Index end : {from, to}) {
        Site<2> in{}, out{}; // beyond the end, in line with the patch and beside it
        in[1 - axis] = out[1 - axis] = end == from ? from - 1 : to;
        in[axis] = upper ? at - 1 : at;
        out[axis] = upper ? at : at - 1;
        if (!shape.active.has(in) || !shape.active.has(out)) continue;
        Site<2> corner{};
        corner[axis] = at;
        corner[1 - axis] = end;
        for (const geom::StraightSide& side : sides) {
          const Index away = std::abs(corner[side.axis] - side.at), along = corner[1 - side.axis];
          if (away >= rows || along < side.from - rows || along > side.to + rows || !free(side)) continue;
          return fmt::format(
              "-pd_patches: patch {} has an inner corner at {}, {} rows from a side of the body: uniform "
              "tension along that side is exact from {} rows on only",
              plan.entries[p][0] + 1, frame.text({shape.line(0, corner[0]), shape.line(1, corner[1])}), away, rows);
        }
      }
  }
  return {};
}

std::string region_warning(const options::SceneOptions& options, const mesh::Mesh& mesh,
                           std::span<const pd::Particle> particles)
{
  if (!options.regions) return {};
  std::vector<int> there(options.regions->count(), 0);
  for (const pd::Particle& particle : particles) there[options.regions->at(particle.x)] = 1;
  for (Index c = 0; c < mesh.owned_cells(); ++c)
    if (mesh.use(c) == mesh::Use::plain || mesh.use(c) == mesh::Use::cut)
      there[options.regions->at(mesh.centroid(c))] = 1;
  MPI_Allreduce(MPI_IN_PLACE, there.data(), static_cast<int>(there.size()), MPI_INT, MPI_MAX, mesh.comm());
  for (std::size_t region = 1; region < there.size(); ++region)
    if (!there[region])
      return fmt::format("-region_{0} holds the middle of no element and no particle and changes nothing: give another "
                         "place (coordinates in m), or drop it",
                         options.regions->name(region));
  return {};
}

template std::vector<std::string> cloud_warnings<2>(const options::SceneOptions&, const CloudPart<2>&);
template std::vector<std::string> cloud_warnings<3>(const options::SceneOptions&, const CloudPart<3>&);
template void require_rows<2>(const options::SceneOptions&, const std::array<Index, 2>&);
template void require_rows<3>(const options::SceneOptions&, const std::array<Index, 3>&);
} // namespace pdx::scene
