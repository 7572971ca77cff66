#include "pdx/scene/solid.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/stable_step.hpp"
#include "support/scene.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

namespace {
using namespace pdx;

constexpr double kYoung = 3.0, kDensity = 0.7, kSpacing = 0.1;
const auto go_on = [] { return solve::TimeDriver::Verdict::go_on; };

/// A block of so many sites, spacing 0.1, the horizon two of them; linear bonds without surface correction.
options::SceneOptions block(Index nx, Index ny, Index nz)
{
  options::SceneOptions options;
  options.solid = true;
  options.elastic = {kYoung, 0.25, law::Plane::strain, nz * kSpacing, kDensity};
  options.mesh.box = {{0.0, 0.0}, {nx * kSpacing, ny * kSpacing}};
  options.pd.everywhere = true;
  options.pd.spacing = {kSpacing};
  options.pd.horizon_ratio = 2.0;
  options.pd.micromodulus = law::Micromodulus::uniform;
  options.pd.surface_correction = options::SurfaceCorrection::none;
  options.time.analysis = options::Analysis::explicit_dynamics;
  return options;
}

options::BoundaryCondition condition(const std::string& name, const std::string& side)
{
  options::BoundaryCondition c;
  c.name = name;
  c.on = side;
  return c;
}

/// A solid as the program builds it. Collective on `comm`.
class SolidScene {
public:
  explicit SolidScene(options::SceneOptions given, MPI_Comm comm = PETSC_COMM_WORLD)
      : options(std::move(given)), mesh_options_(options.mesh), plan(scene::plan_solid(options, mesh_options_)),
        mesh_(mesh::build(comm, mesh_options_, scene::cell_cost(plan))), swarm_(comm),
        solid(scene::discretise(comm, options, plan, scene::make_particles(mesh_, plan, swarm_)))
  {}
  SolidScene(const SolidScene&) = delete;
  SolidScene& operator=(const SolidScene&) = delete;

  /// Steps to `end` [s] in steps of 0.9 of the limit.
  void run(double end)
  {
    const test::Option to("-ts_max_time", fmt::format("{:.17g}", end));
    driver = std::make_unique<solve::ExplicitDriver>(
        solid->system, solve::ExplicitOptions{solve::stable_step(solid->system).limit, 0.9, false});
    driver->run(go_on);
  }

  double sum(double mine) const
  {
    MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, mesh_.comm());
    return mine;
  }

  /// Displacement of one site [m].
  double displacement(const Site<3>& site, std::size_t component) const
  {
    double mine = 0.0;
    for (std::size_t k = 0; k < solid->particles.size(); ++k)
      if (solid->particles[k].site == plan.lattice.number(site)) mine = driver->u()[3 * k + component];
    return sum(mine);
  }

  /// External force in all, by direction [N].
  Vector<3> load() const
  {
    Vector<3> total = Vector<3>::Zero();
    for (std::size_t k = 0; k < solid->system.load.size(); ++k)
      total[static_cast<Eigen::Index>(k % 3)] += solid->system.load[k];
    for (double& value : total) value = sum(value);
    return total;
  }

  options::SceneOptions options;

private:
  mesh::MeshOptions mesh_options_;

public:
  scene::SolidPlan plan;

private:
  mesh::Mesh mesh_;
  pd::Particles swarm_;

public:
  std::unique_ptr<scene::Model> solid;
  std::unique_ptr<solve::ExplicitDriver> driver;
};

/// Behind the front of a plane wave that a wall sends out at speed v0 the strain is -v0 / c_L, until the free sides are
/// felt; c_L = sqrt(1.2 E / rho) at nu = 1/4.
TEST(Solid, CarriesPlaneWavesAtTheSpeedOfTheBulk)
{
  const double v0 = 1e-3, speed = std::sqrt(1.2 * kYoung / kDensity), cross = kSpacing / speed;
  options::SceneOptions options = block(26, 40, 40);
  options::BoundaryCondition wall = condition("wall", "left");
  wall.rows = 2;
  wall.velocity = {v0, 0.0, 0.0};
  wall.history = field::History::ramp(0.0, 7.0 * cross);
  options.conditions = {wall};
  SolidScene scene(options);
  scene.run(20.0 * cross);
  const double strain = (scene.displacement({9, 20, 20}, 0) - scene.displacement({5, 20, 20}, 0)) / (4.0 * kSpacing);
  EXPECT_NEAR(strain / (-v0 / speed), 1.0, 5e-3);
  EXPECT_LT(std::abs(scene.displacement({23, 20, 20}, 0)), 0.02 * std::abs(scene.displacement({9, 20, 20}, 0)));
}

TEST(Solid, KeepsItsEnergyAndHasTheWorkDone)
{
  options::SceneOptions options = block(9, 7, 5);
  options::BoundaryCondition clamp = condition("clamp", "back"), pull = condition("pull", "front");
  clamp.displacement = {0.0, 0.0, 0.0};
  pull.traction = Vector<3>(2e-3, -1e-3, 3e-3);
  pull.history = field::History::ramp(0.0, 0.2);
  options::BoundaryCondition start = condition("start", "");
  start.initial_velocity = Vector<3>(1e-3, 2e-3, -1e-3);
  options.conditions = {start, clamp, pull};
  SolidScene scene(options);
  scene.run(3.0);
  const solve::KineticEnergy kinetic = scene.driver->kinetic_energy();
  const double stored = scene.sum(scene.solid->energies(scene.driver->local()).bonds);
  const double given = scene.driver->clock().initial + scene.sum(scene.driver->moving().work());
  EXPECT_GT(stored, 0.05 * given);
  EXPECT_NEAR((kinetic.moving - kinetic.scheme + stored) / given, 1.0, 1e-10);
}

TEST(Solid, IsLoadedByTractionTimesAreaAndBodyForceTimesVolume)
{
  options::SceneOptions options = block(6, 5, 4);
  options::BoundaryCondition pull = condition("pull", "front"), weight = condition("weight", "");
  pull.traction = Vector<3>(1.0, 2.0, 3.0);
  pull.rows = 2;
  pull.box = {{0.0, 0.0}, {0.3, 0.5}}; // 3 of 6 columns
  weight.body = Vector<3>(0.0, -10.0, 5.0);
  options.conditions = {pull, weight};
  const SolidScene scene(options);
  const Vector<3> wanted = 0.3 * 0.5 * Vector<3>(1.0, 2.0, 3.0) + 0.6 * 0.5 * 0.4 * Vector<3>(0.0, -10.0, 5.0);
  EXPECT_LT((scene.load() - wanted).norm(), 1e-13);
}

TEST(Solid, IsHeldOnRowsUnderASideAsFarAsItsBoxReaches)
{
  options::SceneOptions options = block(6, 5, 4);
  options::BoundaryCondition clamp = condition("clamp", "right");
  clamp.displacement = {0.0, std::nullopt, 0.0};
  clamp.rows = 2;
  clamp.box = {{0.6, 0.0}, {0.6, 0.3}}; // 3 of 5 rows, through the thickness
  options.conditions = {clamp};
  const SolidScene scene(options);
  EXPECT_EQ(scene.sum(static_cast<double>(scene.solid->held_parts[0].components.size())), 2 * 2 * 3 * 4);
  for (const Index component : scene.solid->held_parts[0].components) {
    const Site<3> site = scene.plan.lattice.site(scene.solid->particles[static_cast<std::size_t>(component / 3)].site);
    EXPECT_NE(component % 3, 1);
    EXPECT_GE(site[0], 4);
    EXPECT_LT(site[1], 3);
  }
}

/// A notched block torn open: all kinds of bonds break, over every border between ranks.
options::SceneOptions torn()
{
  options::SceneOptions options = block(14, 12, 5);
  options.kinematics = options::KinematicsOption::finite;
  options.pd.surface_correction = options::SurfaceCorrection::automatic;
  options.cracks.lines = {{{-1.0, 0.6}, {0.45, 0.6}}};
  options.fracture.critical_stretch = 0.01;
  for (const char* side : {"top", "bottom"}) {
    options::BoundaryCondition c = condition(side, side);
    c.velocity = {0.0, side[0] == 't' ? 0.06 : -0.05, 0.0};
    options.conditions.push_back(c);
  }
  return options;
}

TEST(Solid, BreaksTheSameBondsOnAnyNumberOfRanks)
{
  const auto results = [](MPI_Comm comm) {
    SolidScene scene(torn(), comm);
    scene.run(2.0);
    std::array<double, 3> found{scene.sum(static_cast<double>(scene.solid->breaker->mine().bonds)),
                                scene.driver->kinetic_energy().moving, scene.sum(scene.solid->breaker->mine().energy)};
    return found;
  };
  const std::array<double, 3> here = results(PETSC_COMM_WORLD);
  EXPECT_GT(here[0], 300.0);
  for (std::size_t k = 0; k < 3; ++k) {
    const double alone = test::on_one_rank([&](MPI_Comm comm) { return results(comm)[k]; });
    EXPECT_NEAR(here[k] / alone, 1.0, k == 0 ? 0.0 : 1e-9);
  }
}

TEST(Solid, IsPartedByACrackThroughTheThickness)
{
  options::SceneOptions options = block(8, 6, 5);
  options.cracks.lines = {{{-1.0, 0.3}, {2.0, 0.3}}};
  options::BoundaryCondition start = condition("start", "");
  start.box = geom::Box<2>{{0.0, 0.3}, {0.8, 0.6}};
  start.initial_velocity = Vector<3>(0.0, 1.0, 0.5);
  options.conditions = {start};
  SolidScene scene(options);
  scene.run(0.5); // the upper half flies off as it is
  for (const Index z : {0, 2, 4}) {
    EXPECT_EQ(scene.displacement({3, 2, z}, 1), 0.0);
    EXPECT_NEAR(scene.displacement({3, 3, z}, 1), 0.5, 1e-12);
    EXPECT_NEAR(scene.displacement({3, 3, z}, 2), 0.25, 1e-12);
  }
}

TEST(Solid, NamesASpacingThatFitsAllThreeSides)
{
  options::SceneOptions options = block(8, 6, 5);
  options.pd.spacing = {0.11};
  mesh::MeshOptions mesh = options.mesh;
  try {
    (void)scene::plan_solid(options, mesh);
    FAIL() << "a spacing that does not fit was taken";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("fits is 0.1"), std::string::npos) << error.what();
  }
}
} // namespace
