#include "pdx/options/condition_options.hpp"

#include "pdx/base/number.hpp"
#include "pdx/base/options.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/options/time_options.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::options {
namespace condition_options {
bool is_cloud() { return Options("pd").given("-pd_cloud"); }
bool are_points() { return Options("mpm").given("-mpm_bodies"); }

std::array<std::optional<double>, 3> read_components(Options& o, const std::string& name, bool solid, const char* unit,
                                                     const char* help)
{
  const std::vector<std::string> parts = o.texts(name, {}, help);
  std::array<std::optional<double>, 3> held;
  if (parts.empty()) return held;
  if (parts.size() != 2 && !(solid && parts.size() == 3))
    throw UserError(fmt::format("{} has {} values: must have 2{}, a number or the word free each", name, parts.size(),
                                solid ? " or 3" : ""));
  for (std::size_t a = 0; a < parts.size(); ++a) {
    if (parts[a] == "free") continue;
    const std::optional<double> value = number_of(name, parts[a], unit);
    if (!value || !std::isfinite(*value))
      throw UserError(fmt::format("{} is \"{}\" in component {}: must be a finite number or the word free", name,
                                  shown(parts[a]), a + 1));
    held[a] = *value;
  }
  require_units_alike(name, parts);
  return held;
}

std::optional<Vector<2>> read_vector(Options& o, const std::string& name, const char* unit, const char* help)
{
  const std::vector<double> v = o.reals(name, {}, o.given(name) ? 2 : 0, unit, help);
  if (v.empty()) return std::nullopt;
  return Vector<2>(v[0], v[1]);
}

/// Two components, or in a solid three; the third is 0 where it is not given.
std::optional<Vector<3>> read_vector(Options& o, const std::string& name, bool solid, const char* unit,
                                     const char* help)
{
  const bool three = solid && o.texts(name, {}, help).size() == 3;
  const std::vector<double> v = o.reals(name, {}, three ? 3 : o.given(name) ? 2 : 0, unit, help);
  if (v.empty()) return std::nullopt;
  return Vector<3>(v[0], v[1], three ? v[2] : 0.0);
}

/// Rollers, springs, what turns and pins.
void judge_support(const BoundaryCondition& c, const std::string& stem)
{
  const auto refuse_both = [&stem](bool both, const char* a, const char* b) {
    if (both)
      throw UserError(fmt::format("{0}_{1} and {0}_{2} hold the same: make two conditions of them", stem, a, b));
  };
  refuse_both(c.roller && c.shifts(), "roller", c.moves() ? "velocity" : "displacement");
  refuse_both(c.turn && c.shifts(), "turn", c.moves() ? "velocity" : "displacement");
  refuse_both(c.turn && c.roller, "turn", "roller");
  if (c.turn && !c.centre) throw UserError(fmt::format("{0}_turn needs a centre: give {0}_centre x,y", stem));
  if (c.centre && !c.turn) throw UserError(fmt::format("{0}_centre is that of what turns: give {0}_turn", stem));
  if (c.springs && (c.on.empty() || is_cloud()))
    throw UserError(fmt::format("{0}_spring stands on a side: name it with {0}_on (and cut it with {0}_box){1}", stem,
                                is_cloud() ? "; a -pd_cloud has none" : ""));
  if (c.layer && (c.roller || c.springs))
    throw UserError(fmt::format("{0}_layer is held as a whole: give {0}_displacement, or drop {0}_layer", stem));
  if (!c.pin) return;
  if (c.roller || c.turn || c.springs || c.traction || c.body || c.force || c.initial_velocity)
    throw UserError(fmt::format("{0}_pin pushes, and moves by {0}_displacement or {0}_velocity only: make another "
                                "condition of the rest",
                                stem));
  if (!c.on.empty() || c.box || c.set || !c.of.empty())
    throw UserError(fmt::format("{0}_pin pushes whatever it meets: drop {0}_on, _box, _set and _of", stem));
  if (!c.at) throw UserError(fmt::format("{0}_pin needs a place: give {0}_at x,y, its middle at the start", stem));
}

void judge(const BoundaryCondition& c)
{
  const std::string stem = "-bc_" + c.name;
  if (!c.holds() && !c.traction && !c.body && !c.force && !c.initial_velocity && !c.springs && !c.pin)
    throw UserError(fmt::format(
        "{0}: nothing is prescribed: give {0}_displacement, {0}_roller, {0}_turn, {0}_spring, {0}_traction, {0}_body, "
        "{0}_force or {0}_pin (in time also {0}_velocity or {0}_initial_velocity)",
        stem));
  for (std::size_t a = 0; a < 3; ++a)
    if (c.displacement[a] && c.velocity[a])
      throw UserError(fmt::format("{0}_velocity holds what {0}_displacement holds already: write free for one", stem));
  judge_support(c, stem);
  if (c.at && !c.force && !c.pin)
    throw UserError(fmt::format("{0}_at is the place of a point force: give {0}_force fx,fy, or hold what lies on a "
                                "boundary {0}_on or in a {0}_box",
                                stem));
  if ((c.holds() || c.traction) && c.on.empty() && !c.box && !c.set && c.of.empty())
    throw UserError(fmt::format("{0}: no place given: name a boundary with {0}_on, or a box with {0}_box (of a cloud: "
                                "a box or {0}_set)",
                                stem));
  if (c.set && !is_cloud())
    throw UserError(fmt::format("{0}_set is of the particles of a -pd_cloud: choose by {0}_on or {0}_box", stem));
  if (!c.of.empty() && !are_points())
    throw UserError(fmt::format("{0}_of is a body of -mpm_bodies: choose by {0}_on or {0}_box", stem));
  if (c.traction && c.on.empty() && !is_cloud())
    throw UserError(
        fmt::format("{0}_traction needs edges: name their boundary with {0}_on (and cut it with {0}_box)", stem));
  if (c.force && !c.at && !is_cloud()) throw UserError(fmt::format("{0}_force needs a place: give {0}_at x,y", stem));
  if (!c.on.empty() && !c.holds() && !c.traction && !c.initial_velocity && !c.springs)
    throw UserError(fmt::format("{0}_on is {1}: a body force acts everywhere or in {0}_box, a point force at {0}_at; "
                                "drop {0}_on",
                                stem, c.on));
  const bool driven = c.shifts() || c.turn || c.traction || c.body || c.force;
  if (c.history && !driven)
    throw UserError(fmt::format("{0}_history acts on loads and on what moves: {1}", stem,
                                c.initial_velocity ? stem + "_initial_velocity is given once, at the start"
                                                   : "rollers, springs and a pin without a motion stay as they are"));
  if (c.layer && c.box) throw UserError(fmt::format("{0}_box cannot cut {0}_layer: a layer is held as a whole", stem));
  if (c.layer && (!c.holds() || c.on.empty()))
    throw UserError(
        fmt::format("{0}_layer holds particles outside a boundary: give {0}_on and {0}_displacement", stem));
}

/// A unit vector; none where the option is not given.
std::optional<Vector<3>> read_direction(Options& o, const std::string& name, bool solid, const char* help)
{
  std::optional<Vector<3>> given = read_vector(o, name, solid, "-", help);
  if (!given) return given;
  const double length = given->norm();
  if (!(length > 0.0) || !std::isfinite(length))
    throw UserError(fmt::format("{} is {:g},{:g}: must be a direction, not 0", name, (*given)[0], (*given)[1]));
  return *given / length;
}

void read_supports(Options& o, const std::string& stem, bool solid, double young, BoundaryCondition& c)
{
  c.roller = read_direction(o, stem + "_roller", solid,
                            "direction nx,ny (solid: ,nz) along which it is held at 0, and free across");
  const std::vector<double> springs =
      o.reals(stem + "_spring", {}, 0, "N/m^3",
              "springs between a side and the ground: stiffness along its normal by area[, and across it]",
              Range::at_least(0.0));
  const std::optional<Vector<3>> along =
      read_direction(o, stem + "_spring_along", solid, "direction nx,ny of the springs instead of the normal");
  if (springs.size() > 2 || (!springs.empty() && *std::ranges::max_element(springs) == 0.0))
    throw UserError(fmt::format("{}_spring has {} value{}: must be one stiffness above 0, or two, along and across",
                                stem, springs.size(), springs.size() == 1 ? " that is 0" : "s"));
  if (along && springs.empty())
    throw UserError(fmt::format("{0}_spring_along is the direction of springs: give {0}_spring", stem));
  if (!springs.empty()) c.springs = Springs{springs[0], springs.size() > 1 ? springs[1] : 0.0, along};
  const double turn = o.real(stem + "_turn", std::numeric_limits<double>::quiet_NaN(), "rad",
                             "angle by which it turns as a rigid body about _centre, counter-clockwise, e.g. 30deg");
  if (!std::isnan(turn)) c.turn = turn;
  c.centre = read_vector(o, stem + "_centre", "m", "place x,y that it turns about");
  const double radius = o.real(stem + "_pin", std::numeric_limits<double>::quiet_NaN(), "m",
                               "radius of a rigid pin with its middle at _at, which pushes what it meets and "
                               "moves by _displacement or _velocity",
                               Range::positive());
  const double stiffness =
      o.real(stem + "_pin_stiffness", young, "Pa", "modulus of the layer between pin and body; usually -material_young",
             Range::positive());
  if (!std::isnan(radius)) c.pin = Pin{radius, stiffness};
  if (std::isnan(radius) && o.given(stem + "_pin_stiffness"))
    throw UserError(fmt::format("{0}_pin_stiffness is that of a pin: give its radius with {0}_pin", stem));
}

BoundaryCondition read_condition(const std::string& name, bool solid, double young, bool describe)
{
  Options o("bc");
  const std::string stem = "-bc_" + name;
  BoundaryCondition c;
  c.name = name;
  c.on = o.text(stem + "_on", "",
                "boundary of the mesh: left, right, bottom, top (solid: back, front), or a physical group");
  const auto box = o.reals(stem + "_box", {}, o.given(stem + "_box") ? 4 : 0, "m", "only what lies in x0,y0,x1,y1");
  if (!box.empty()) {
    c.box = geom::Box<2>{{box[0], box[1]}, {box[2], box[3]}};
    if ((c.box->size().array() < 0.0).any())
      throw UserError(fmt::format("{}_box is {},{},{},{}: must be x0,y0,x1,y1 with x0 <= x1 and y0 <= y1", stem, box[0],
                                  box[1], box[2], box[3]));
  }
  if (const int set = o.integer(stem + "_set", 0, "of a cloud: only particles of this set"); o.given(stem + "_set"))
    c.set = set;
  c.of = o.text(stem + "_of", "", "of material points: only this body");
  c.displacement = read_components(o, stem + "_displacement", solid, "m",
                                   "held displacement ux,uy (solid: ,uz) [m]; free leaves a component");
  c.velocity = read_components(o, stem + "_velocity", solid, "m/s",
                               "held velocity vx,vy [m/s], in time; the word free as above");
  c.initial_velocity =
      read_vector(o, stem + "_initial_velocity", solid, "m/s", "velocity vx,vy at the start, free afterwards");
  c.traction = read_vector(o, stem + "_traction", solid, "Pa", "constant traction tx,ty on the boundary");
  c.body = read_vector(o, stem + "_body", solid, "N/m^3", "body force bx,by");
  c.force = read_vector(o, stem + "_force", solid, "N",
                        "point force fx,fy on the nearest node or particle, shared by equally near ones; of a cloud: "
                        "on what _box and _set choose, by volume");
  c.at = read_vector(o, stem + "_at", "m", "place x,y of the point force, or of the pin");
  read_supports(o, stem, solid, young, c);
  c.history = read_history(o, stem);
  c.rows = o.integer(stem + "_rows", 1, "particle rows under the boundary that take part", {1.0, 1e6});
  c.layer = o.boolean(stem + "_layer", false, "hold a layer of one horizon of particles outside the boundary");
  if (describe) return c;
  judge(c);
  return c;
}
} // namespace condition_options

std::vector<BoundaryCondition> read_conditions(bool solid, double young, bool describe)
{
  Options o("bc");
  std::vector<std::string> names = o.texts("-bc_names", {}, "names of the boundary conditions that follow");
  if (describe) names = {"NAME"};
  std::vector<BoundaryCondition> conditions;
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1)
      throw UserError(fmt::format("-bc_names lists {} twice: names must differ", name));
    conditions.push_back(condition_options::read_condition(name, solid, young, describe));
  }
  return conditions;
}
} // namespace pdx::options
