#include "pdx/options/scene_options.hpp"

#include "pdx/base/number.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/law/bond.hpp"
#include "pdx/options/adapt_options.hpp"
#include "pdx/options/material_options.hpp"
#include "pdx/options/option_names.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::options {
namespace {
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

geom::Box<2> box_of(const std::string& name, const std::vector<double>& v, std::size_t at)
{
  const geom::Box<2> box{{v[at], v[at + 1]}, {v[at + 2], v[at + 3]}};
  if ((box.size().array() <= 0.0).any())
    throw UserError(fmt::format("{} is {},{},{},{}: must be x0,y0,x1,y1 with x0 < x1 and y0 < y1", name, v[at],
                                v[at + 1], v[at + 2], v[at + 3]));
  return box;
}

bool is_cloud() { return Options("pd").given("-pd_cloud"); }
bool are_points() { return Options("mpm").given("-mpm_bodies"); }

void read_patches(Options& o, PdOptions& pd)
{
  static constexpr const char* seeds[] = {"none", "tip"};
  pd.seeded =
      o.choice("-adapt_seed", 0, seeds,
               "where no -pd_patches are given: none, or a patch at each tip of a crack, of the elements with a "
               "node as near as -adapt_expansion_length") == 1;
  const std::string text = o.text("-pd_patches", "", "patches: x0,y0,x1,y1[,more] [m], or all");
  if (text.empty()) return;
  if (text == "all") {
    pd.everywhere = true;
    return;
  }
  const std::vector<double> v = o.reals("-pd_patches", {}, 0, "m", "");
  if (v.size() % 4)
    throw UserError(
        fmt::format("-pd_patches has {} numbers: must be four per patch, x0,y0,x1,y1, or the word all", v.size()));
  for (std::size_t k = 0; k < v.size(); k += 4) pd.patches.push_back(box_of("-pd_patches", v, k));
}

void require_poisson(const PdOptions& pd, const law::Elastic& elastic, bool solid, double horizon)
{
  try {
    if (solid)
      (void)law::BondLaw<3>(pd.micromodulus, elastic, horizon);
    else
      (void)law::BondLaw<2>(pd.micromodulus, elastic, horizon);
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("-material_poisson is {}: {}", elastic.poisson, wrong.what()));
  }
}

PdOptions read_pd(const law::Elastic& elastic, bool solid, bool describe)
{
  Options o("pd");
  PdOptions pd;
  static constexpr const char* moduli[] = {"uniform", "conical"};
  static constexpr const char* calibrations[] = {"continuum", "lattice"};
  static constexpr const char* corrections[] = {"auto", "none", "volume", "exact"};
  static constexpr const char* operators[] = {"auto", "matrix_free", "assembled"};
  read_patches(o, pd);
  pd.to_come = Triggers::are_given();
  pd.cloud = o.text("-pd_cloud", "", "particles that lie anywhere, from a file *.csv or *.h5: position, volume, set");
  pd.horizon = o.real("-pd_horizon", kNone, "m", "horizon of -pd_cloud", Range::positive());
  pd.spacing =
      o.reals("-pd_spacing", {}, 0, "m", "lattice spacing dx, one for all patches or one each", Range::positive());
  pd.horizon_ratio = o.real("-pd_horizon_ratio", 4.0, "-", "horizon / dx", Range::at_least(1.0));
  pd.micromodulus =
      static_cast<law::Micromodulus>(o.choice("-pd_micromodulus", 1, moduli, "c(xi): constant, or falling linearly"));
  pd.calibration = static_cast<pd::Calibration>(
      o.choice("-pd_calibration", 1, calibrations, "bond constants: the papers', or exact for the lattice"));
  pd.surface_correction = static_cast<SurfaceCorrection>(o.choice(
      "-pd_surface_correction", 0, corrections,
      "bonds at free surfaces: auto = exact in the plane, volume in space; none; volume = the papers'; exact = right "
      "in uniform stress and bending"));
  pd.solver = static_cast<PdOperator>(
      o.choice("-pd_operator", 0, operators, "tangent: matrix-free two-level, or one assembled matrix"));
  pd.skip_tolerance = o.real("-pd_skip_tolerance", 0.0, "m",
                             "explicit: bonds among displacements up to this size are left out; 0 changes no result, "
                             "below 0 none are");
  if (describe) return pd;
  if (o.given("-pd_horizon") && pd.cloud.empty())
    throw UserError("-pd_horizon is that of a -pd_cloud: give -pd_horizon_ratio for particles of a lattice");
  if (!pd.any()) return pd;
  if (!pd.cloud.empty() && std::isnan(pd.horizon))
    throw UserError("-pd_horizon is missing: give the horizon of the cloud's bonds in m, e.g. three particles");
  if (!pd.cloud.empty()) {
    require_poisson(pd, elastic, solid, pd.horizon);
    return pd;
  }
  if (pd.spacing.empty() && !pd.seeded)
    throw UserError("-pd_spacing is missing: give the lattice spacing of the patches in m");
  if (pd.spacing.size() > 1 && pd.spacing.size() != pd.patches.size() && !pd.seeded)
    throw UserError(fmt::format("-pd_spacing has {} values for {} patches: give one, or one per patch",
                                pd.spacing.size(), pd.patches.size()));
  const double dx = pd.spacing.empty() ? 1.0 : pd.spacing[0]; // the ratio is that of any horizon
  require_poisson(pd, elastic, solid, pd.horizon_ratio * dx);
  return pd;
}

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

void judge(const BoundaryCondition& c)
{
  const std::string stem = "-bc_" + c.name;
  if (!c.holds() && !c.traction && !c.body && !c.force && !c.initial_velocity)
    throw UserError(
        fmt::format("{0}: nothing is prescribed: give {0}_displacement, {0}_traction, {0}_body or {0}_force "
                    "(in time also {0}_velocity or {0}_initial_velocity)",
                    stem));
  for (std::size_t a = 0; a < 3; ++a)
    if (c.displacement[a] && c.velocity[a])
      throw UserError(fmt::format("{0}_velocity holds what {0}_displacement holds already: write free for one", stem));
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
  if (c.at && !c.force)
    throw UserError(fmt::format("{0}_at is the place of a point force: give {0}_force fx,fy", stem));
  if (!c.on.empty() && !c.holds() && !c.traction && !c.initial_velocity)
    throw UserError(fmt::format("{0}_on is {1}: a body force acts everywhere or in {0}_box, a point force at {0}_at; "
                                "drop {0}_on",
                                stem, c.on));
  if (c.history && !c.holds() && !c.traction && !c.body && !c.force)
    throw UserError(fmt::format("{0}_history acts on loads and on what is held: {0}_initial_velocity is given once, at "
                                "the start",
                                stem));
  if (c.layer && c.box) throw UserError(fmt::format("{0}_box cannot cut {0}_layer: a layer is held as a whole", stem));
  if (c.layer && (!c.holds() || c.on.empty()))
    throw UserError(
        fmt::format("{0}_layer holds particles outside a boundary: give {0}_on and {0}_displacement", stem));
}

BoundaryCondition read_condition(const std::string& name, bool solid, bool describe)
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
  c.at = read_vector(o, stem + "_at", "m", "place x,y of the point force");
  c.history = read_history(o, stem);
  c.rows = o.integer(stem + "_rows", 1, "particle rows under the boundary that take part", {1.0, 1e6});
  c.layer = o.boolean(stem + "_layer", false, "hold a layer of one horizon of particles outside the boundary");
  if (describe) return c;
  judge(c);
  return c;
}

std::vector<BoundaryCondition> read_conditions(bool solid, bool describe)
{
  Options o("bc");
  std::vector<std::string> names = o.texts("-bc_names", {}, "names of the boundary conditions that follow");
  if (describe) names = {"NAME"};
  std::vector<BoundaryCondition> conditions;
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1)
      throw UserError(fmt::format("-bc_names lists {} twice: names must differ", name));
    conditions.push_back(read_condition(name, solid, describe));
  }
  return conditions;
}

void judge_time(const SceneOptions& s)
{
  judge_adapt(s);
  if (!s.output.times.empty() && !Options("output").given("-output_fields"))
    throw UserError("-output_times say when fields are written: give -output_fields too");
  if (s.time.checkpoint.any() && s.time.analysis == Analysis::implicit_dynamics)
    throw UserError("-checkpoint_... and -restart: implicit steps have no checkpoint; give -analysis explicit or "
                    "static, or drop them");
  if (s.layout.rebalance_threshold > 0.0 && s.time.analysis != Analysis::explicit_dynamics)
    throw UserError("-rebalance_threshold deals out the work of explicit steps: give -analysis explicit, or drop it");
  if (s.layout.renew_interval > 0 && s.time.analysis == Analysis::implicit_dynamics)
    throw UserError("-layout_renew_interval: implicit steps keep their layout; give -analysis explicit or static");
  if (s.time.subcycle > 1 && s.time.analysis == Analysis::implicit_dynamics)
    throw UserError("-ts_subcycle parts explicit steps: give -analysis explicit, or drop it");
  if (s.time.subcycle > 1 && s.time.dynamic() && (s.points.any() || s.solid || is_cloud()))
    throw UserError(
        "-ts_subcycle parts elements from particles in the plane: drop it where there are material points, a "
        "cloud or a solid");
  if (s.time.dynamic()) {
    for (const char* name : {"-load_steps", "-load_halvings", "-load_passes", "-load_broken_share", "-static_condense",
                             "-pd_release", "-pd_release_share"})
      if (Options("load").given(name))
        throw UserError(fmt::format("{} acts in load steps: give -analysis static, or drop it", name));
    if (s.elastic.density <= 0.0)
      throw UserError("-material_density is missing: things that move have a mass; give it in kg/m^3");
    if (s.scheme == couple::Scheme::interface)
      throw UserError("-couple_scheme interface is not symmetric and grows without bound in time: use energy or ghost");
    if (s.post.reference_fe || s.post.energy_release)
      throw UserError("-post_reference_fe and -post_energy_release compare equilibria: they need -analysis static");
    if (s.post.modes) throw UserError("-post_modes is of equilibria: it needs -analysis static");
    return;
  }
  if (!s.output.times.empty()) throw UserError("-output_times acts in time: give -analysis explicit or implicit");
  for (const BoundaryCondition& c : s.conditions)
    if (c.moves() || c.initial_velocity || c.history)
      throw UserError(fmt::format("-bc_{}_{} acts in time: give -analysis explicit or implicit", c.name,
                                  c.moves()   ? "velocity"
                                  : c.history ? "history"
                                              : "initial_velocity"));
}

/// Solids are particles that move; nothing else knows the third direction.
void judge_solid(const SceneOptions& s)
{
  const std::string solid = "-material_plane solid ";
  if (!s.pd.everywhere) throw UserError(solid + "is of particles only: give -pd_patches all");
  if (s.time.analysis != Analysis::explicit_dynamics) throw UserError(solid + "needs -analysis explicit");
  if (s.pd.solver != PdOperator::automatic) throw UserError(solid + "has no tangent: drop -pd_operator");
  if (s.pd.surface_correction == SurfaceCorrection::exact)
    throw UserError(solid + "has no -pd_surface_correction exact, which is of the plane: give volume or none");
  if (s.post.any_j()) throw UserError(solid + "cannot stand beside -post_j_...: J is of the plane");
  for (const BoundaryCondition& c : s.conditions) {
    if (c.layer) throw UserError(fmt::format("{}has no -bc_{}_layer: hold rows of particles by _rows", solid, c.name));
    if (c.force)
      throw UserError(fmt::format("{}has no -bc_{}_force: give _body in a box, or _traction", solid, c.name));
  }
}

void judge(const SceneOptions& s)
{
  judge_thermal(s);
  if (s.points.any()) return judge_points(s), judge_regions(s), judge_time(s);
  if (s.pd.seeded) judge_seeds(s);
  if (!s.pd.cloud.empty()) return judge_cloud(s), judge_regions(s), judge_time(s);
  if (s.solid) judge_solid(s);
  const bool layered = std::any_of(s.conditions.begin(), s.conditions.end(), [](const auto& c) { return c.layer; });
  if (layered && !s.pd.everywhere)
    throw UserError("-bc_..._layer holds particles outside the body: it needs -pd_patches all");
  if (s.pd.everywhere && !s.mesh.file.empty())
    throw UserError(
        "-pd_patches all makes its own background mesh: give -mesh_lower and -mesh_upper instead of -mesh_file");
  if (!s.pd.everywhere && s.mesh.file.empty() && s.mesh.cells[0] == 0)
    throw UserError("-mesh_cells is missing: give the number of cells nx,ny of the box, or a -mesh_file");
  if (s.post.reference_fe && layered)
    throw UserError(
        "-post_reference_fe cannot stand beside -bc_..._layer: the reference has no material outside the body");
  if (s.fracture.active() && !s.pd.any())
    throw UserError("-material_toughness breaks bonds, but there are no particles: give -pd_patches");
  if (!s.post.j_contours.empty() && !s.pd.any())
    throw UserError("-post_j_contours lie in a patch, but there is none: give -post_j_domain for elements");
  if (s.post.any_j() && s.cracks.lines.empty() && !s.post.j_centre)
    throw UserError("-post_j_... needs a crack: give -crack_names, or -post_j_centre");
  judge_time(s);
  judge_regions(s);
  if (!s.time.dynamic() &&
      std::none_of(s.conditions.begin(), s.conditions.end(), [](const auto& c) { return c.holds(); }))
    throw UserError("the body is not held anywhere: give a -bc_NAME_displacement");
}

SceneOptions read_all(bool describe)
{
  SceneOptions s;
  Options o("scene"), bonds("couple");
  static constexpr const char* kinematics[] = {"small", "finite", "mixed"};
  static constexpr const char* schemes[] = {"energy", "ghost", "interface"};
  (void)o.text("-options_file", "", "file with an option a line: -name value, # begins a comment");
  s.case_name = o.text("-case", "case", "name of the case");
  s.kinematics = static_cast<Kinematics>(
      o.choice("-kinematics", are_points() ? 1 : 0, kinematics,
               "linear; finite strain; the papers' finite bonds with linear elements; beside material points finite"));
  try {
    s.mesh = mesh::MeshOptions::read(!is_cloud() && !are_points());
  } catch (const UserError&) {
    if (!describe) throw;
  }
  const Materials materials = Materials::read();
  const Material named = materials.named("-material", "a material by name, e.g. soda_lime_glass: its young, poisson, "
                                                      "density and toughness, where they are not given");
  s.elastic = read_material(named, describe, s.solid);
  s.pd = read_pd(of_bonds(s, named), s.solid, describe);
  if (!describe && s.pd.any()) take_required_poisson(s);
  s.points = PointOptions::read(s.elastic, s.solid, describe);
  using couple::Scheme;
  s.scheme = static_cast<Scheme>(bonds.choice("-couple_scheme", 0, schemes, "how bonds act beyond a patch"));
  s.face_mass = bonds.boolean("-couple_face_mass", false, "in time: particles hand mass to their border");
  if (s.points.coupling == Coupling::handshake && s.scheme == Scheme::energy) s.scheme = Scheme::handshake;
  s.cracks = CrackOptions::read();
  s.fracture = FractureOptions::read(s.pd.any() ? named.toughness : std::nullopt);
  s.region_set = RegionSetOptions::read(materials, s.elastic, s.pd.any(), describe);
  if (!s.fracture.active() && s.region_set.toughness()) {
    s.fracture.toughness = s.region_set.toughness();
    s.fracture.rest_breaks = false;
  }
  s.thermal = ThermalOptions::read(describe);
  s.conditions = read_conditions(s.solid, describe);
  s.load = LoadOptions::read();
  s.time = TimeOptions::read();
  s.layout = LayoutOptions::read();
  s.post = PostOptions::read();
  s.output = OutputOptions::read(s.case_name, s.time.dynamic());
  s.probes = ProbeOptions::read(s.solid, s.output.history_interval, describe);
  return s;
}
} // namespace

SceneOptions SceneOptions::read(bool describe)
{
  if (describe) return read_all(true);
  forget_documented_options();
  SceneOptions s = unless_misspelt([] { return read_all(false); });
  refuse_unlisted();
  refuse_unknown_options();
  judge(s);
  return s;
}
} // namespace pdx::options
