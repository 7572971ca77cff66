#include "pdx/options/scene_options.hpp"

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

geom::Box<3> box_in_space(const std::vector<double>& v, std::size_t k)
{
  const geom::Box<3> box{{v[k], v[k + 1], v[k + 2]}, {v[k + 3], v[k + 4], v[k + 5]}};
  if ((box.lower.array() < box.upper.array()).all()) return box;
  throw UserError(fmt::format(
      "-pd_patches is {}: must be the lower corner, then the upper one",
      fmt::join(v.begin() + static_cast<std::ptrdiff_t>(k), v.begin() + static_cast<std::ptrdiff_t>(k) + 6, ",")));
}

void read_patches(Options& o, bool solid, PdOptions& pd)
{
  static constexpr const char* seeds[] = {"none", "tip"};
  pd.seeded =
      o.choice("-adapt_seed", 0, seeds,
               "where no -pd_patches are given: none, or a patch at each tip of a crack, of the elements with a "
               "node as near as -adapt_expansion_length") == 1;
  const std::string text = o.text("-pd_patches", "",
                                  "patches: x0,y0,x1,y1[,more] [m], or all (solid, of bodies of points: "
                                  "x0,y0,z0,x1,y1,z1[,more])");
  if (text.empty()) return;
  if (text == "all") {
    pd.everywhere = true;
    return;
  }
  const std::vector<double> v = o.reals("-pd_patches", {}, 0, "m", "");
  if (solid && are_points()) {
    if (v.size() % 6)
      throw UserError(fmt::format(
          "-pd_patches has {} numbers: must be six per box of bodies of points in space, x0,y0,z0,x1,y1,z1", v.size()));
    for (std::size_t k = 0; k < v.size(); k += 6) pd.boxes.push_back(box_in_space(v, k));
    return;
  }
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
  read_patches(o, solid, pd);
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
  if (pd.spacing.size() > 1 && pd.spacing.size() != pd.patches.size() && !pd.seeded && pd.boxes.empty())
    throw UserError(fmt::format("-pd_spacing has {} values for {} patches: give one, or one per patch",
                                pd.spacing.size(), pd.patches.size()));
  const double dx = pd.spacing.empty() ? 1.0 : pd.spacing[0]; // the ratio is that of any horizon
  require_poisson(pd, elastic, solid, pd.horizon_ratio * dx);
  return pd;
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
  for (const BoundaryCondition& c : s.conditions)
    if (s.time.subcycle > 1 && (c.roller || c.springs || c.turn || c.pin))
      throw UserError(fmt::format("-ts_subcycle knows no rollers, springs, turns or pins: drop it, or -bc_{}", c.name));
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
  for (const BoundaryCondition& c : s.conditions) {
    const std::string stem = "-bc_" + c.name;
    if (c.moves() || c.initial_velocity)
      throw UserError(fmt::format("{}_{} acts in time: give -analysis explicit or implicit", stem,
                                  c.moves() ? "velocity" : "initial_velocity"));
    if (c.history)
      throw UserError(fmt::format("{0}_history is a factor in time, and in statics loads grow evenly to what is given "
                                  "(-load_steps): drop {0}_history..., or give -analysis explicit or implicit",
                                  stem));
  }
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
  if (s.fracture.scatter.any() && !s.fracture.active())
    throw UserError("-pd_scatter spreads the stretch at which bonds break, and none breaks: give -material_toughness");
  if (!s.post.j_contours.empty() && !s.pd.any())
    throw UserError("-post_j_contours lie in a patch, but there is none: give -post_j_domain for elements");
  if (s.post.any_j() && s.cracks.lines.empty() && !s.post.j_centre)
    throw UserError("-post_j_... needs a crack: give -crack_names, or -post_j_centre");
  judge_time(s);
  judge_regions(s);
  if (!s.time.dynamic() &&
      std::none_of(s.conditions.begin(), s.conditions.end(), [](const auto& c) { return c.supports(); }))
    throw UserError("the body is not held anywhere: give a -bc_NAME_displacement, _roller, _spring or _pin");
}

SceneOptions read_all(bool describe)
{
  SceneOptions s;
  Options o("scene"), bonds("couple");
  static constexpr const char* kinematics[] = {"small", "finite", "mixed"};
  static constexpr const char* schemes[] = {"energy", "ghost", "interface"};
  (void)o.text("-options_file", "", "file with an option a line: -name value, # begins a comment");
  s.case_name = o.text("-case", "case", "name of the case");
  s.kinematics = static_cast<KinematicsOption>(
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
  s.conditions = read_conditions(s.solid, s.elastic.young, describe);
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
