#include "pdx/options/point_options.hpp"

#include "pdx/mesh/gmsh.hpp"
#include "pdx/options/adapt_options.hpp"
#include "pdx/options/polygon.hpp"
#include "pdx/options/scene_options.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace pdx::options {
namespace {
constexpr const char* kShapes[] = {"box", "disc", "sphere", "polygon", "mesh", "file"};
constexpr int kMostSites = 64; // of a cell: one bit each

/// As many numbers as an option has, or none.
std::vector<double> numbers(Options& o, const std::string& name, std::size_t count, const char* help)
{
  return o.reals(name, {}, o.given(name) ? count : 0, "m", help);
}

void read_box(Options& o, const std::string& stem, bool solid, PointShape& shape)
{
  const std::size_t dim = solid ? 3 : 2;
  const std::vector<double> v =
      numbers(o, stem + "_box", 2 * dim, "a box of points: x0,y0,x1,y1 (solid: x0,y0,z0,x1,y1,z1)");
  if (v.empty()) return;
  geom::Box<3> box;
  for (std::size_t d = 0; d < dim; ++d) {
    const auto a = static_cast<Eigen::Index>(d);
    box.lower[a] = v[d];
    box.upper[a] = v[dim + d];
    if (!(v[d] < v[dim + d]))
      throw UserError(fmt::format("{}_box is {}: must be the lower corner, then the upper one", stem,
                                  fmt::join(v.begin(), v.end(), ",")));
  }
  shape.box = box;
}

std::optional<PointShape::Ball> ball_of(const std::string& name, const std::vector<double>& v)
{
  if (v.empty()) return std::nullopt;
  PointShape::Ball ball;
  for (std::size_t d = 0; d + 1 < v.size(); ++d) ball.centre[static_cast<Eigen::Index>(d)] = v[d];
  ball.radius = v.back();
  if (!(ball.radius > 0.0))
    throw UserError(fmt::format("{} has the radius {:g} m: must be above 0", name, ball.radius));
  return ball;
}

void read_holes(Options& o, const std::string& stem, PointShape& shape)
{
  const std::string name = stem + "_hole";
  const std::vector<double> v = numbers(
      o, name, 0, "round holes x,y,radius[,x,y,radius]: cells of the grid with their middle in one are left out");
  if (v.size() % 3)
    throw UserError(fmt::format("{} has {} numbers: must be x,y,radius of one hole or more", name, v.size()));
  for (std::size_t k = 0; k < v.size(); k += 3) shape.holes.push_back(*ball_of(name, {v[k], v[k + 1], v[k + 2]}));
}

void read_region(Options& o, const std::string& stem, bool describe, PointShape& shape)
{
  const std::string file =
      o.text(stem + "_mesh", "", "a Gmsh mesh of cells of three or four nodes, filled with points");
  const std::string region = o.text(stem + "_region", "", "its physical surface that is filled; all of it by default");
  if (describe) return;
  if (!file.empty())
    shape.border = mesh::read_gmsh_border(stem + "_mesh", file, region);
  else if (!region.empty())
    throw UserError(fmt::format("{0}_region is of a {0}_mesh, and there is none: give it, or drop this", stem));
}

PointShape read_shape(Options& o, const std::string& stem, bool solid, bool describe)
{
  PointShape shape;
  read_box(o, stem, solid, shape);
  shape.disc = ball_of(stem + "_disc", numbers(o, stem + "_disc", 3, "a disc: x,y,radius (solid: a cylinder along z)"));
  read_holes(o, stem, shape);
  shape.sphere = ball_of(stem + "_sphere", numbers(o, stem + "_sphere", 4, "solid: a sphere: x,y,z,radius"));
  shape.border = read_polygon(o, stem + "_polygon");
  read_region(o, stem, describe, shape);
  shape.file = o.text(stem + "_file", "", "points on a lattice from a file *.csv or *.h5, as of -pd_cloud");
  const std::vector<double> z =
      numbers(o, stem + "_depth", 2, "solid: where disc, polygon or region begin and end along z");
  if (describe) return shape;
  std::vector<std::string> given;
  for (const char* kind : kShapes)
    if (o.given(stem + "_" + kind)) given.push_back(fmt::format("{}_{}", stem, kind));
  if (given.size() != 1)
    throw UserError(fmt::format("{0}: a body of points needs one shape: give one of {0}_box, _disc, _sphere, "
                                "_polygon, _mesh, _file{1}",
                                stem, given.empty() ? "" : fmt::format("; there are {}", fmt::join(given, " and "))));
  const bool plane = shape.disc || !shape.border.empty();
  if (shape.sphere && !solid) throw UserError(stem + "_sphere is of space: give -material_plane solid, or _disc");
  if (!z.empty() && !(solid && plane))
    throw UserError(stem + "_depth is of discs, polygons and regions in space (-material_plane solid): drop it");
  if (solid && plane && z.empty())
    throw UserError(stem + "_depth is missing: give z0,z1 in m, where the body begins and ends along z");
  if (z.empty()) return shape;
  if (!(z[0] < z[1])) throw UserError(fmt::format("{}_depth is {:g},{:g}: must be z0 < z1", stem, z[0], z[1]));
  shape.z_lower = z[0];
  shape.z_upper = z[1];
  return shape;
}

Vector<3> read_motion(Options& o, const std::string& name, bool solid, const char* unit, const char* help)
{
  const std::vector<double> v = o.reals(name, {}, o.given(name) ? (solid ? 3 : 2) : 0, unit, help);
  return v.empty() ? Vector<3>(0.0, 0.0, 0.0) : Vector<3>(v[0], v[1], solid ? v[2] : 0.0);
}

Vector<3> read_spin(Options& o, const std::string& name, bool solid)
{
  const std::vector<double> v = o.reals(name, {}, o.given(name) ? (solid ? 3 : 1) : 0, "1/s",
                                        "angular velocity about its centre at the start (solid: wx,wy,wz)");
  if (v.empty()) return Vector<3>::Zero();
  return solid ? Vector<3>(v[0], v[1], v[2]) : Vector<3>(0.0, 0.0, v[0]);
}

PointBodyOptions read_body(Options& o, const std::string& name, const law::Elastic& elastic, double spacing, bool solid,
                           bool describe)
{
  const std::string stem = "-mpm_" + name;
  PointBodyOptions body;
  body.name = name;
  body.shape = read_shape(o, stem, solid, describe);
  body.elastic = elastic;
  body.elastic.young =
      o.real(stem + "_young", elastic.young, "Pa", "Young's modulus; usually -material_young", Range::positive());
  body.elastic.poisson =
      o.real(stem + "_poisson", elastic.poisson, "-", "Poisson's ratio; usually -material_poisson", {-0.999, 0.4999});
  body.elastic.density = o.real(stem + "_density", elastic.density, "kg/m^3", "mass density; usually -material_density",
                                Range::positive());
  body.spacing =
      o.real(stem + "_spacing", spacing, "m", "spacing of its points; usually -mpm_spacing", Range::positive());
  body.shape.move(read_motion(o, stem + "_translation", solid, "m",
                              "dx,dy (solid: ,dz) from where its shape, holes and file say that it lies to its place"));
  body.velocity = read_motion(o, stem + "_velocity", solid, "m/s", "velocity at the start vx,vy (solid: ,vz)");
  body.spin = read_spin(o, stem + "_spin", solid);
  if (describe) return body;
  if (std::isnan(body.spacing))
    throw UserError(fmt::format("-mpm_spacing is missing: give the spacing of the points in m, for all bodies or by "
                                "{}_spacing",
                                stem));
  if (body.elastic.density <= 0.0)
    throw UserError(
        fmt::format("{0}_density is missing: give it in kg/m^3, or -material_density for all bodies", stem));
  return body;
}

void judge_condition(const SceneOptions& s, const BoundaryCondition& c)
{
  const std::string stem = "-bc_" + c.name;
  std::vector<std::string> names;
  for (const PointBodyOptions& body : s.points.bodies) names.push_back(body.name);
  if (s.mesh.cells[0] > 0 || !s.mesh.file.empty()) names.emplace_back(kMeshBody);
  if (!c.of.empty() && std::ranges::find(names, c.of) == names.end()) {
    throw UserError(
        fmt::format("{}_of is {}: no body has that name; bodies are {}", stem, c.of, fmt::join(names, ", ")));
  }
  if ((c.force || (c.at && !c.pin)) && !s.mixed())
    throw UserError(fmt::format("{0}_force has no meaning for material points: give {0}_body or {0}_traction", stem));
  if (c.layer || (c.rows != 1 && !s.mixed()) || c.set)
    throw UserError(fmt::format("{0}_{1} is of particles: choose points by {0}_of, {0}_on or {0}_box", stem,
                                c.layer ? "layer"
                                : c.set ? "set"
                                        : "rows"));
}
} // namespace

void PointShape::move(const Vector<3>& by)
{
  if (box) box = geom::Box<3>{box->lower + by, box->upper + by};
  for (std::optional<Ball>* ball : {&disc, &sphere})
    if (*ball) (*ball)->centre += by;
  for (Ball& hole : holes) hole.centre += by;
  for (auto& edge : border)
    for (Vector<2>& x : edge) x += by.head<2>();
  z_lower += by[2];
  z_upper += by[2];
  file_moved += by;
}

PointShape PointShape::inside(const geom::Frame& frame) const
{
  PointShape moved = *this;
  if (box) moved.box = geom::Box<3>{frame.inside(box->lower), frame.inside(box->upper)};
  if (disc) moved.disc->centre = frame.inside(disc->centre);
  if (sphere) moved.sphere->centre = frame.inside(sphere->centre);
  for (Ball& hole : moved.holes) hole.centre = frame.inside(hole.centre);
  for (auto& edge : moved.border)
    for (Vector<2>& x : edge) x = frame.inside(x);
  if (z_lower < z_upper) {
    moved.z_lower = frame.inside(Vector<3>(0.0, 0.0, z_lower))[2];
    moved.z_upper = frame.inside(Vector<3>(0.0, 0.0, z_upper))[2];
  }
  return moved;
}

geom::Box<3> PointShape::around() const
{
  if (box) return *box;
  geom::Box<3> all;
  if (const std::optional<Ball>& ball = disc ? disc : sphere) {
    all = {ball->centre.array() - ball->radius, ball->centre.array() + ball->radius};
  } else {
    constexpr double far = std::numeric_limits<double>::max();
    all = {Vector<3>::Constant(far), Vector<3>::Constant(-far)};
    for (const auto& edge : border)
      for (const Vector<2>& x : edge) {
        all.lower.head<2>() = all.lower.head<2>().cwiseMin(x).eval();
        all.upper.head<2>() = all.upper.head<2>().cwiseMax(x).eval();
      }
  }
  if (!sphere) {
    all.lower[2] = z_lower;
    all.upper[2] = z_upper;
  }
  return all;
}

PointOptions PointOptions::read(const law::Elastic& elastic, bool solid, bool describe)
{
  Options o("mpm");
  PointOptions points;
  static constexpr const char* formulations[] = {"total", "updated"};
  static constexpr const char* laws[] = {"corotational", "neo_hooke"};
  std::vector<std::string> names = o.texts("-mpm_bodies", {}, "names of the bodies of material points that follow");
  if (describe) names = {"NAME"};
  const double spacing = o.real("-mpm_spacing", std::numeric_limits<double>::quiet_NaN(), "m",
                                "spacing dx of material points", Range::positive());
  points.formulation =
      static_cast<Formulation>(o.choice("-mpm_formulation", 0, formulations,
                                        "grid of the reference state, kept; or fixed in space, made anew each step"));
  points.law = static_cast<mpm::Law>(
      o.choice("-mpm_law", 0, laws, "stress: linear in the stretch (Biot), turned along; or neo-Hooke"));
  points.ratio = o.integer("-mpm_cell_ratio", 2, "side of the grid's cells over dx", {1.0, solid ? 4.0 : 8.0});
  static constexpr const char* couplings[] = {"energy", "handshake"};
  points.coupling = static_cast<Coupling>(o.choice(
      "-mpm_coupling", 0, couplings,
      "bonds of particles act on points up to the border of both; or whole on the points themselves (APDMPM)"));
  static constexpr const char* orders[] = {"musl", "usl", "usf"};
  static constexpr const char* shapes[] = {"hat", "gimp", "bspline"};
  points.grid.order =
      static_cast<mpm::Order>(o.choice("-mpm_order", 0, orders,
                                       "updated: stress last, by velocities of moved points; last, which with hats may "
                                       "blow up where nodes have little mass; or first in a step"));
  points.grid.shape = static_cast<mpm::Shape>(o.choice(
      "-mpm_shape", 0, shapes, "updated: hats, hats meant over a point's square (uGIMP), quadratic B-splines"));
  points.grid.pic = o.real("-mpm_pic", 0.0, "-",
                           "updated: share of the grid's velocity that points take, 0: FLIP, 1: PIC", {0.0, 1.0});
  points.viscosity = o.real("-mpm_bulk_viscosity", 0.0, "-",
                            "explicit: linear bulk viscosity b, pressure b rho c_L h against what shrinks or grows",
                            Range::at_least(0.0));
  points.skips_rest = o.boolean("-mpm_skip_rest", true,
                                "explicit, total: cells of points that have not moved are left out; changes no result");
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1)
      throw UserError(fmt::format("-mpm_bodies lists {} twice: names must differ", name));
    points.bodies.push_back(read_body(o, name, elastic, spacing, solid, describe));
  }
  static_assert(4 * 4 * 4 <= kMostSites && 8 * 8 <= kMostSites);
  if (!describe && points.bodies.empty())
    for (const char* name : {"-mpm_spacing", "-mpm_formulation", "-mpm_law", "-mpm_cell_ratio", "-mpm_bulk_viscosity",
                             "-mpm_order", "-mpm_shape", "-mpm_pic", "-mpm_skip_rest", "-mpm_coupling"})
      if (o.given(name))
        throw UserError(fmt::format("{} is of material points, and there are none: give -mpm_bodies", name));
  points.contact = ContactOptions::read(points.any(), describe);
  return points;
}

namespace {
/// What has no meaning where material points stand alone, or beside elements and particles.
void refuse_other_physics(const SceneOptions& s)
{
  static constexpr const char* never[] = {"-pd_cloud",      "-post_j_contours",     "-post_j_domain",
                                          "-post_j_centre", "-post_energy_release", "-post_reference_fe",
                                          "-post_modes"};
  static constexpr const char* alone[] = {"-crack_names",   "-material_toughness", "-pd_critical_stretch",
                                          "-kinematics",    "-xfem_quadrature",    "-adapt",
                                          "-couple_scheme", "-couple_face_mass",   "-mpm_coupling"};
  const Options o("mpm");
  for (const char* name : never)
    if (o.given(name)) throw UserError(fmt::format("{} cannot stand beside -mpm_bodies: drop one of them", name));
  if (!s.mixed() && !s.mixed_in_space())
    for (const char* name : alone)
      if (o.given(name))
        throw UserError(fmt::format("{} is of elements and particles, and there are material points only: give "
                                    "-pd_patches or a mesh too, or drop it",
                                    name));
}

/// Points beside elements and particles, in the plane.
void judge_mixed(const SceneOptions& s)
{
  const std::string beside = "bodies of points beside elements or particles";
  if (s.points.formulation == Formulation::updated) throw UserError(beside + " need -mpm_formulation total");
  if (s.pd.everywhere)
    throw UserError("-pd_patches all: a body of points is no box mesh: give the boxes of its cells that are particles");
  if (s.kinematics == KinematicsOption::small)
    throw UserError("-kinematics small: bodies of points turn, and bonds must turn with them: give finite (the default "
                    "beside points) or mixed");
  if (s.scheme != couple::Scheme::energy && s.scheme != couple::Scheme::handshake)
    throw UserError(beside + " need -couple_scheme energy (-mpm_coupling handshake is the papers')");
  if (s.scheme == couple::Scheme::handshake && s.time.analysis != Analysis::explicit_dynamics)
    throw UserError("-mpm_coupling handshake is for comparison in explicit steps: give -analysis explicit, or energy");
  if (s.mesh.file.empty() && s.mesh.cells[0] == 0 && s.mesh.box.size().norm() > 0.0)
    throw UserError("-mesh_cells is missing: give the number of cells nx,ny of the box, or a -mesh_file");
  for (const PointBodyOptions& body : s.points.bodies)
    if (body.name == kMeshBody)
      throw UserError(fmt::format("-mpm_bodies: {} is what elements are called: choose another name", kMeshBody));
  if (s.pd.seeded) judge_seeds(s);
}

/// Points beside particles in space: whole cells of their grids, one spacing, explicit steps.
void judge_mixed_in_space(const SceneOptions& s)
{
  const std::string beside = "-material_plane solid: bodies of points beside particles ";
  if (s.time.analysis != Analysis::explicit_dynamics) throw UserError(beside + "need -analysis explicit");
  if (s.points.formulation == Formulation::updated) throw UserError(beside + "need -mpm_formulation total");
  if (s.pd.everywhere)
    throw UserError("-pd_patches all: a body of points is no box mesh: give the boxes of its cells that are particles");
  if (s.scheme != couple::Scheme::energy)
    throw UserError(beside + "are coupled by energy only: drop -mpm_coupling handshake (-couple_scheme)");
  if (s.kinematics != KinematicsOption::finite) throw UserError(beside + "turn, and bonds with them: drop -kinematics");
  if (s.face_mass) throw UserError(beside + "hand no mass over: drop -couple_face_mass");
  if (s.pd.seeded || !s.cracks.lines.empty())
    throw UserError(beside + "have no cracks from the start: drop -crack_names (-adapt_seed)");
  if (s.layout.adapt == Adapt::relocate || s.layout.hand_back > 0 || s.layout.renew_box)
    throw UserError(beside + "do not become points again: give -adapt expand, without -adapt_hand_back and "
                             "-layout_renew_box");
  if (s.pd.solver != PdOperator::automatic) throw UserError(beside + "have no tangent: drop -pd_operator");
  if (s.mesh.cells[0] > 0 || !s.mesh.file.empty())
    throw UserError(beside + "have no elements: drop -mesh_cells (-mesh_file)");
  if (s.fracture.scatter.any()) throw UserError(beside + "break at one stretch: drop -pd_scatter");
  if (s.pd.spacing.size() > 1)
    throw UserError(
        fmt::format("-pd_spacing has {} values: must be one, that of the points, in space", s.pd.spacing.size()));
}
} // namespace

namespace {
/// Points whose equations are solved, in statics or in implicit steps.
void judge_solved(const SceneOptions& s)
{
  const std::string given = s.time.dynamic() ? "-analysis implicit" : "-analysis static";
  const std::size_t bodies = s.points.bodies.size() + (s.mesh.cells[0] > 0 || !s.mesh.file.empty() ? 1 : 0);
  if (s.points.contact.active && bodies > 1 && s.points.contact.friction > 0.0)
    throw UserError(given + " knows no friction between bodies: give -analysis explicit, or drop -contact_friction");
  if (s.points.viscosity > 0.0)
    throw UserError("-mpm_bulk_viscosity is of explicit steps: give -analysis explicit, or drop it");
  if (s.pd.any() && s.pd.solver == PdOperator::matrix_free)
    throw UserError("-pd_operator matrix_free knows no material points: give assembled, or drop it");
  if (s.time.dynamic()) return;
  if (s.solid) throw UserError("-analysis static has material points in the plane only: give -analysis explicit");
  for (const PointBodyOptions& body : s.points.bodies)
    if (!body.velocity.isZero() || !body.spin.isZero())
      throw UserError(fmt::format("-mpm_{}_{}: nothing moves by itself in statics; drop it", body.name,
                                  body.velocity.isZero() ? "spin" : "velocity"));
}
} // namespace

namespace {
/// In space points have no elements beside them.
void refuse_elements(const SceneOptions& s)
{
  const Options o("mesh");
  for (const char* name : {"-mesh_cells", "-mesh_file", "-mesh_lower", "-mesh_upper"})
    if (s.solid && o.given(name))
      throw UserError(fmt::format(
          "{} is of elements, and in space (-material_plane solid) none stand beside -mpm_bodies: drop it", name));
}
} // namespace

void judge_points(const SceneOptions& s)
{
  refuse_other_physics(s);
  if (!s.mixed_in_space()) refuse_elements(s);
  judge_grid(s);
  if (s.time.analysis != Analysis::explicit_dynamics) judge_solved(s);
  if (s.mixed()) judge_mixed(s);
  if (s.mixed_in_space()) judge_mixed_in_space(s);
  for (const BoundaryCondition& c : s.conditions) judge_condition(s, c);
}
} // namespace pdx::options
