#include "pdx/scene/scene_warnings.hpp"

#include "condition_sides.hpp"
#include "pdx/base/given_options.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>

namespace pdx::scene {
namespace {
constexpr double kOnRow = 1e-6; // of a spacing

bool pushes(const std::optional<Vector<3>>& load) { return load && !load->isZero(0.0); }

bool moves(const std::array<std::optional<double>, 3>& components)
{
  return std::ranges::any_of(components, [](const auto& c) { return c && *c != 0.0; });
}

bool loads(const options::BoundaryCondition& c)
{
  return pushes(c.traction) || pushes(c.body) || pushes(c.force) || pushes(c.initial_velocity) ||
         moves(c.displacement) || moves(c.velocity) || (c.turn && *c.turn != 0.0);
}

/// Of times of which none comes: a run may well be cut short.
std::string late_warning(const options::SceneOptions& options)
{
  const GivenOption* given = given_option("-ts_max_time");
  const double last = given ? number_of("-ts_max_time", given->value, "s").value_or(0.0) : 0.0;
  const std::vector<double>& times = options.output.times;
  if (times.empty() || !(last > 0.0) || std::ranges::min(times) <= last) return {};
  return fmt::format("-output_times asks for fields at {:g} s and later, after the end of the run at {:g} s "
                     "(-ts_max_time): none are written then",
                     std::ranges::min(times), last);
}

std::string time_warning(const options::SceneOptions& options)
{
  if (options.time.dynamic()) return late_warning(options);
  for (const char* name :
       {"-ts_max_time", "-ts_max_steps", "-ts_dt", "-ts_safety", "-ts_allow_unstable", "-ts_subcycle"})
    if (Options("ts").given(name))
      return fmt::format("{} acts in time and changes nothing in statics: give -analysis explicit or implicit, or drop "
                         "it",
                         name);
  return {};
}

/// What says how something is done that is not done in statics.
std::string static_warning(const options::SceneOptions& options)
{
  if (options.time.dynamic()) return {};
  if (Options("post").given("-post_section"))
    return "-post_section tells when sections break in time, and changes nothing in statics: give -analysis explicit, "
           "or "
           "drop it";
  return {};
}

/// What turns by a finite angle strains where strains are linear.
std::string turn_warning(const options::SceneOptions& options)
{
  constexpr double little = 1e-3; // strain
  if (options.kinematics != options::KinematicsOption::small) return {};
  for (const options::BoundaryCondition& c : options.conditions)
    if (const double strain = c.turn ? 1.0 - std::cos(std::min(std::abs(*c.turn), 2.0)) : 0.0; strain > little)
      return fmt::format(
          "-bc_{}_turn is {:.3g} rad, which strains what it turns by {:.2g} with -kinematics small: give "
          "finite, or a smaller angle",
          c.name, *c.turn, strain);
  return {};
}

/// Points that rest are left out in explicit steps only.
std::string rest_warning(const options::SceneOptions& options)
{
  if (options.time.analysis == options::Analysis::explicit_dynamics || !Options("mpm").given("-mpm_skip_rest"))
    return {};
  return "-mpm_skip_rest is of explicit steps, and changes nothing here: give -analysis explicit, or drop it";
}

std::string load_warning(const options::SceneOptions& options)
{
  const bool flies = std::ranges::any_of(options.points.bodies, [](const options::PointBodyOptions& body) {
    return !body.velocity.isZero(0.0) || !body.spin.isZero(0.0);
  });
  if (flies || options.thermal.active() || std::ranges::any_of(options.conditions, loads)) return {};
  return "nothing loads or moves the body, so it stays as it is: give a -bc_NAME_traction, _body, _force, or a "
         "_displacement that is not 0 (in time also _velocity or _initial_velocity)";
}

/// Does the shape of a body end in a plane on that side? Of a file that is not known.
bool is_straight(const options::PointShape& shape, const BoxSide& on)
{
  constexpr double near = 1e-9; // of the size
  if (shape.sphere) return false;
  if (shape.disc) return on.axis == 2;
  if (shape.border.empty() || on.axis == 2) return true;
  const geom::Box<3> around = shape.around();
  const auto axis = static_cast<Eigen::Index>(on.axis);
  const double side = (on.high ? around.upper : around.lower)[axis], off = near * around.size().head<2>().maxCoeff();
  return std::ranges::any_of(shape.border, [&](const auto& edge) {
    return std::abs(edge[0][axis] - side) <= off && std::abs(edge[1][axis] - side) <= off;
  });
}

/// Faces of points on a side are those of the outermost ones: of a round body few.
std::string round_warning(const options::SceneOptions& options, const options::BoundaryCondition& c)
{
  const std::optional<BoxSide> on = box_side(c.on, options.solid ? 3 : 2);
  if (!on || !(c.traction || c.springs) || c.box) return {};
  for (const options::PointBodyOptions& body : options.points.bodies)
    if ((c.of.empty() || c.of == body.name) && !is_straight(body.shape, *on))
      return fmt::format(
          "-bc_{0}_{1} acts on the outermost points of {2} alone, which is not straight on its side {3}: "
          "a force on all of it is -bc_{0}_body",
          c.name, c.traction ? "traction" : "spring", body.name, c.on);
  return {};
}

/// What moves a body: a component that is not given is free, which is easily forgotten in space.
std::string third_warning(const options::BoundaryCondition& c)
{
  const std::string name = fmt::format("-bc_{}_velocity", c.name);
  if (Options("bc").texts(name, {}, "").size() != 2) return {};
  return fmt::format("{} has two components in space: along z it is free; write a third, {},free or another", name,
                     Options("bc").text(name, "", ""));
}

/// Is there a site of the patch in row `row` across `axis` between two places along the other axis?
bool has_sites(const couple::PatchShape& shape, std::size_t axis, Index row, double from, double to)
{
  Site<2> site{};
  site[axis] = row;
  const auto along = static_cast<Eigen::Index>(1 - axis);
  for (site[1 - axis] = 0; site[1 - axis] < shape.lattice.count[1 - axis]; ++site[1 - axis]) {
    const double x = shape.lattice.point(site)[along];
    if (x > from && x < to && shape.active.has(site)) return true;
  }
  return false;
}

bool runs_along_row(const couple::PatchShape& shape, const Vector<2>& a, const Vector<2>& b)
{
  const double near = kOnRow * shape.lattice.dx;
  for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
    const auto d = static_cast<Eigen::Index>(axis);
    if (std::abs(a[d] - b[d]) > near) continue;
    const double row = (a[d] - shape.lattice.origin[d]) / shape.lattice.dx - 0.5;
    if (std::abs(row - std::round(row)) > kOnRow) continue;
    const auto [from, to] = std::minmax(a[1 - d], b[1 - d]);
    if (has_sites(shape, axis, static_cast<Index>(std::lround(row)), from, to)) return true;
  }
  return false;
}
} // namespace

namespace {
/// A table that ends before the body or its time does.
std::string table_warning(const options::SceneOptions& options)
{
  constexpr double rounding = 1e-9;
  const options::ThermalOptions& t = options.thermal;
  if (!t.table) return {};
  const Vector<2> lower = options.frame.given<2>(options.mesh.box.lower),
                  upper = options.frame.given<2>(options.mesh.box.upper);
  const std::array<std::array<double, 2>, 3> wanted{{{0.0, t.duration}, {lower[0], upper[0]}, {lower[1], upper[1]}}};
  static constexpr const char* kinds[] = {"s in time", "m along x", "m along y"};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<double>& axis = t.table->axes[k];
    const auto [first, last] = wanted[k];
    const double near = rounding * (last - first);
    if (axis.size() < 2 || (axis.front() <= first + near && axis.back() >= last - near)) continue;
    return fmt::format(
        "-thermal_file goes from {:g} to {:g} {}, and {} from {:g} to {:g}: beyond its ends temperatures "
        "stay as they are there",
        axis.front(), axis.back(), kinds[k], k ? "the body" : "the run", first, last);
  }
  return {};
}
} // namespace

std::vector<std::string> option_warnings(const options::SceneOptions& options)
{
  std::vector<std::string> lines{time_warning(options), static_warning(options), rest_warning(options),
                                 turn_warning(options), load_warning(options),   table_warning(options)};
  for (const options::BoundaryCondition& c : options.conditions) lines.push_back(round_warning(options, c));
  if (options.solid)
    for (const options::BoundaryCondition& c : options.conditions) lines.push_back(third_warning(c));
  const std::vector<std::string> of_regions = options::region_warnings(options);
  lines.insert(lines.end(), of_regions.begin(), of_regions.end());
  std::erase(lines, "");
  return lines;
}

std::string row_warning(const options::SceneOptions& options, const PatchPlan& plan)
{
  for (std::size_t crack = 0; crack < options.cracks.lines.size(); ++crack) {
    const crack::Polyline& line = options.cracks.lines[crack];
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
      for (const couple::PatchShape& shape : plan.shapes)
        if (runs_along_row(shape, line[k], line[k + 1]))
          return fmt::format("crack {} runs along a row of particles from {} to {}, which count as left of it: the "
                             "crack is half a spacing off its line; move it or the patch by half a spacing ({:.6g} m)",
                             crack + 1, options.frame.text(line[k]), options.frame.text(line[k + 1]),
                             0.5 * shape.lattice.dx);
  }
  return {};
}

std::string size_warning(const options::SceneOptions& options, double largest, const geom::Box<2>& body)
{
  const double size = body.size().maxCoeff();
  if (options.kinematics != options::KinematicsOption::small || !(largest > size)) return {};
  return fmt::format(
      "the largest displacement is {:.3g} m and the body {:.3g} m: small strains mean nothing there; look "
      "at units of loads and -material_young, or give -kinematics finite",
      largest, size);
}
} // namespace pdx::scene
