#include "pdx/options/fracture_options.hpp"

#include "pdx/base/options.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/base/text_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace pdx::options {
namespace {
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

crack::Polyline line_of(const std::string& where, const std::vector<double>& v)
{
  if (v.size() < 4 || v.size() % 2)
    throw UserError(
        fmt::format("{} has {} numbers: a crack needs two points or more, x0,y0,x1,y1,...", where, v.size()));
  crack::Polyline line;
  for (std::size_t k = 0; k < v.size(); k += 2) line.emplace_back(v[k], v[k + 1]);
  return line;
}

/// A crack a line: x0 y0 x1 y1 ..., commas or blanks between; # begins a comment.
std::vector<crack::Polyline> read_file(const std::string& name)
{
  TextFile file("-crack_file", name);
  std::vector<crack::Polyline> lines;
  while (file.next()) {
    std::vector<double> values;
    for (const std::string_view word : words_of(file.line())) values.push_back(file.real(word));
    if (!values.empty()) lines.push_back(line_of(file.where(), values));
  }
  if (lines.empty()) throw UserError(fmt::format("-crack_file is {}: has no crack", shown_path(name)));
  return lines;
}

std::vector<geom::Box<2>> boxes_of(const std::string& name, const std::vector<double>& v)
{
  if (v.size() % 4)
    throw UserError(fmt::format("{} has {} numbers: must be four per box, x0,y0,x1,y1", name, v.size()));
  std::vector<geom::Box<2>> boxes;
  for (std::size_t k = 0; k < v.size(); k += 4) {
    boxes.push_back({{v[k], v[k + 1]}, {v[k + 2], v[k + 3]}});
    if ((boxes.back().size().array() <= 0.0).any())
      throw UserError(fmt::format("{} is {},{},{},{}: must be x0,y0,x1,y1 with x0 < x1 and y0 < y1", name, v[k],
                                  v[k + 1], v[k + 2], v[k + 3]));
  }
  return boxes;
}

std::optional<double> optional_real(Options& o, const std::string& name, const char* unit, const char* help,
                                    std::optional<double> usual = std::nullopt)
{
  const double value = o.real(name, usual.value_or(kNone), unit, help, Range::positive());
  return std::isnan(value) ? std::nullopt : std::optional(value);
}
} // namespace

CrackOptions CrackOptions::read()
{
  Options o("crack");
  CrackOptions c;
  const std::string file = o.text("-crack_file", "", "file with a crack a line: x0 y0 x1 y1 ... [m]");
  const std::vector<std::string> names = o.texts("-crack_names", {}, "names of the cracks that follow");
  if (!file.empty()) c.lines = read_file(file);
  for (const std::string& name : names) {
    if (std::ranges::count(names, name) > 1)
      throw UserError(fmt::format("-crack_names lists {} twice: names must differ", name));
    const std::string points = fmt::format("-crack_{}_points", name);
    if (!o.given(points))
      throw UserError(fmt::format("{} is missing: give the points of the crack, x0,y0,x1,y1,...", points));
    c.lines.push_back(line_of(
        points, o.reals(points, {}, 0, "m", "points x0,y0,x1,y1,... of the crack; ends on the surface are open")));
  }
  if (names.empty())
    (void)o.reals("-crack_NAME_points", {}, 0, "m",
                  "points x0,y0,x1,y1,... of the crack; ends on the surface are open");
  Options x("xfem");
  static constexpr const char* quadratures[] = {"polygons", "grid"};
  c.rule.quadrature = static_cast<xfem::Quadrature>(
      x.choice("-xfem_quadrature", 0, quadratures, "cut elements: exact parts, or the papers' 32 x 32 grid"));
  c.rule.least_share = x.real("-xfem_least_share", c.rule.least_share, "-",
                              "part of a node's support below which its side is closed", {0.0, 0.5});
  return c;
}

FractureOptions FractureOptions::read(std::optional<double> usual)
{
  Options o("pd");
  FractureOptions f;
  static constexpr const char* toughnesses[] = {"lattice", "continuum"};
  static constexpr const char* releases[] = {"all", "worst"};
  f.toughness = optional_real(o, "-material_toughness", "J/m^2", "energy release rate Gc; without it nothing breaks",
                              o.given("-pd_critical_stretch") ? std::nullopt : usual);
  f.critical_stretch =
      optional_real(o, "-pd_critical_stretch", "-", "stretch at which bonds break, instead of -material_toughness");
  f.by = static_cast<pd::Toughness>(
      o.choice("-pd_toughness", 0, toughnesses,
               "whose energy per area is Gc: the lattice's as it is, or the papers' continuum's"));
  f.no_fail =
      boxes_of("-pd_no_fail", o.reals("-pd_no_fail", {}, 0, "m", "boxes x0,y0,x1,y1[,more] in which no bond breaks"));
  f.release = static_cast<couple::Release>(
      o.choice("-pd_release", 0, releases, "which overstretched bonds break before the next solve"));
  f.release_share = o.real("-pd_release_share", f.release_share, "-",
                           "worst: part of the overstretched bonds that breaks in a pass", {0.0, 1.0, true});
  f.scatter.width =
      o.real("-pd_scatter", 0.0, "-",
             "stretches at which bonds break vary by place, up to this part of them up and down", {0.0, 0.9});
  f.scatter.seed = static_cast<std::uint64_t>(
      o.integer("-pd_scatter_seed", static_cast<int>(f.scatter.seed), "another draw of -pd_scatter", {0.0, 1e9}));
  if (o.given("-pd_scatter_seed") && !f.scatter.any())
    throw UserError("-pd_scatter_seed draws stretches that do not vary: give -pd_scatter, or drop it");
  if (f.toughness && f.critical_stretch)
    throw UserError("-material_toughness and -pd_critical_stretch say the same: give one of them");
  return f;
}

LoadOptions LoadOptions::read()
{
  Options o("load");
  LoadOptions l;
  l.steps = o.integer("-load_steps", l.steps, "equal steps up to the full load", {1.0, 1e9});
  l.halvings = o.integer("-load_halvings", l.halvings, "how often a step that fails may be halved", {0.0, 30.0});
  l.passes = o.integer("-load_passes", l.passes, "solves at one load above which the step is halved", {1.0, 1e9});
  l.broken_share = o.real("-load_broken_share", l.broken_share, "-",
                          "part of all bonds broken in a step above which it is halved", {0.0, 1.0, true});
  static constexpr const char* condense[] = {"auto", "on", "off"};
  l.condense = static_cast<Condense>(
      o.choice("-static_condense", 0, condense, "eliminate elements that do not change once per layout"));
  return l;
}

PostOptions PostOptions::read()
{
  Options o("post");
  PostOptions p;
  p.reference_fe = o.boolean("-post_reference_fe", false, "also solve with elements only and report errors (Eq. 28)");
  p.j_contours =
      o.reals("-post_j_contours", {}, 0, "m", "J in a patch on square contours with these sides", Range::positive());
  const auto centre = o.reals("-post_j_centre", {}, o.given("-post_j_centre") ? 2 : 0, "m",
                              "centre x,y of the contours; default: the crack's tip");
  if (!centre.empty()) p.j_centre = Vector<2>(centre[0], centre[1]);
  const auto ring = o.reals("-post_j_domain", {}, o.given("-post_j_domain") ? 2 : 0, "m",
                            "J in elements over a square ring: inner and outer half-width", Range::positive());
  if (!ring.empty()) p.j_domain = std::array{ring[0], ring[1]};
  if (p.j_domain && ring[0] >= ring[1])
    throw UserError(
        fmt::format("-post_j_domain is {},{}: the inner half-width must be below the outer", ring[0], ring[1]));
  p.modes = o.boolean("-post_modes", false,
                      "K_I, K_II and the T-stress apart, on the contours or the ring that J is asked for on");
  if (p.modes && p.j_contours.empty() && !p.j_domain)
    throw UserError("-post_modes says nothing of where: give -post_j_domain (a ring of elements) or -post_j_contours "
                    "(squares in a patch)");
  p.energy_release = o.boolean("-post_energy_release", false,
                               "J as -dPi/da: two more solves, the tip moved either way by a lattice period");
  static constexpr const char* axes[] = {"none", "x", "y"};
  p.section =
      o.choice("-post_section", 0, axes,
               "in time: axis along which the first section of particles that is broken right through is told, as "
               "spall_position and spall_time") -
      1;
  p.tip_damage = o.real("-post_tip_damage", p.tip_damage, "-",
                        "in time: damage, precrack included, from which a particle lies beside a crack", {0.0, 1.0});
  p.precrack_as_damage = o.boolean("-post_precrack_as_damage", false, "count the bonds of given cracks as damage");
  return p;
}
} // namespace pdx::options
