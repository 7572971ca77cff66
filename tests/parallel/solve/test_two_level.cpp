#include "support/pulled.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
constexpr int kMostIterations = 16; // of CG, to 1e-10 of the residual

/// Clamped on the left, pulled and sheared on the right; the middle quarter is a patch of n x n particles, 4 x 4 in the
/// place of an element.
options::SceneOptions clamped_plate(Index n)
{
  auto options = test::held_plate({n / 2, n / 2});
  options.conditions.resize(1); // left
  options.conditions.push_back(test::pull("right", {1e-3, 5e-4}));
  return test::with_patch(options, {{0.25, 0.25}, {0.75, 0.75}}, 0.5 / n);
}

/// The same plate of n x n particles, clamped by a layer of one horizon, with three free sides.
options::SceneOptions clamped_particles(Index n) { return test::pulled_particles(n, {1e-3, 5e-4}); }

double iterations(const options::SceneOptions& options, MPI_Comm comm)
{
  test::Scene scene(options, false, comm);
  scene.solve();
  return scene.report().linear_iterations;
}

void expect_few_iterations(const options::SceneOptions& options)
{
  const double found = iterations(options, PETSC_COMM_WORLD);
  EXPECT_GT(found, 1);
  EXPECT_LE(found, kMostIterations);
}

void expect_few_iterations_on_any_number_of_ranks(const options::SceneOptions& options)
{
  const double found = iterations(options, PETSC_COMM_WORLD);
  const double alone = test::on_one_rank([&](MPI_Comm comm) { return iterations(options, comm); });
  EXPECT_GT(found, 1);
  EXPECT_LE(found, kMostIterations);
  EXPECT_LE(std::abs(found - alone), 2.0);
}

void expect_assembled_solution(const options::SceneOptions& options)
{
  test::Scene free(options), whole(options, true);
  EXPECT_TRUE(free.system().coarse);
  EXPECT_FALSE(whole.system().coarse);
  const VecHandle a = free.solve(), b = whole.solve();
  const double gap = test::difference(a.get(), b.get(), NORM_INFINITY);
  EXPECT_LT(gap, 1e-8);
}
} // namespace

TEST(TwoLevel, FewIterationsForPatchesOfAnySize)
{
  for (const Index n : {40, 80}) expect_few_iterations_on_any_number_of_ranks(clamped_plate(n));
  expect_few_iterations(clamped_plate(160));
}

TEST(TwoLevel, FewIterationsForParticlesOnlyOfAnySize)
{
  for (const Index n : {40, 80}) expect_few_iterations_on_any_number_of_ranks(clamped_particles(n));
  expect_few_iterations(clamped_particles(160));
}

TEST(TwoLevel, FewIterationsForALayerAllAround)
{
  auto options = test::held_particles(80);
  options::BoundaryCondition weight;
  weight.name = "weight";
  weight.body = Vector<3>(0.0, -1e-3, 0.0);
  options.conditions.push_back(weight);
  expect_few_iterations_on_any_number_of_ranks(options);
}

TEST(TwoLevel, SolvesWhatTheAssembledMatrixSolves)
{
  expect_assembled_solution(clamped_plate(40));
  expect_assembled_solution(clamped_particles(40));
}

// One particle in a corner of four cells: nine fine and nine coarse rows, so sizes do not tell interpolation and
// restriction apart.
TEST(TwoLevel, AsManyCoarseRowsAsFineOnes)
{
  auto options = test::held_plate({2, 2});
  options.conditions.resize(1); // left
  options.conditions.push_back(test::pull("right", {1e-3, 5e-4}));
  expect_few_iterations(test::with_patch(options, {{0.5, 0.5}, {1.0, 1.0}}, 0.5));
}

TEST(TwoLevel, SupportsInParticleRowsAndFreeSurfaces)
{
  auto options = clamped_particles(40);
  options.conditions[0].layer = false;
  options.conditions[0].rows = 3;
  expect_assembled_solution(options);
}

TEST(TwoLevel, ChosenParticlesInABoxHoldTheBody)
{
  auto options = clamped_particles(40);
  options::BoundaryCondition& clamp = options.conditions[0];
  clamp.layer = false;
  clamp.on = "";
  clamp.box = geom::Box<2>{{0.0, 0.0}, {0.2, 0.1}};
  expect_assembled_solution(options);
}

TEST(TwoLevel, InterfaceSchemeConvergesByGmres)
{
  auto options = clamped_plate(40);
  options.scheme = couple::Scheme::interface;
  test::Scene free(options);
  const VecHandle a = free.solve();
  EXPECT_LE(free.report().linear_iterations, 2 * kMostIterations);
  test::Scene whole(options, true);
  const VecHandle b = whole.solve();
  EXPECT_LT(test::difference(a.get(), b.get(), NORM_INFINITY), 1e-8);
}

TEST(TwoLevel, AFewRows)
{
  options::BoundaryCondition weight;
  weight.name = "weight";
  weight.body = Vector<3>(1e-3, 2e-3, 0.0);
  auto corner = test::held_plate({2, 2}, {{0.0, 0.0}, {2.0, 2.0}});
  auto middle = test::held_plate({3, 3}, {{0.0, 0.0}, {3.0, 3.0}});
  for (options::SceneOptions* options : {&corner, &middle}) {
    options->conditions.resize(1);
    options->conditions.push_back(weight);
  }
  corner = test::with_patch(corner, {{1.0, 1.0}, {2.0, 2.0}}, 0.5); // 8 nodes, 4 particles
  middle = test::with_patch(middle, {{1.0, 1.0}, {2.0, 2.0}}, 1.0); // 16 nodes, one particle
  expect_assembled_solution(corner);
  expect_assembled_solution(middle);
}

TEST(TwoLevel, NothingToDoWithoutPatches)
{
  auto options = test::held_plate({2, 2});
  options.conditions.resize(1);
  options.conditions.push_back(test::pull("right", {1e-3, 0.0}));
  options.conditions[0].displacement[1].reset(); // slides up and down
  options::BoundaryCondition pin;
  pin.name = "pin";
  pin.box = geom::Box<2>{{0.0, 0.0}, {0.0, 0.0}};
  pin.displacement = {0.0, 0.0};
  options.conditions.push_back(pin);
  test::Scene scene(options, true);
  EXPECT_EQ(scene.rows().total, 9);
  const VecHandle u = scene.solve();
  // Uniaxial stress: e_xx = p / E, e_yy = -nu e_xx.
  EXPECT_LT(scene.max_error(u.get(), test::affine(1e-3 / 3.0, 0.0, 0.0, -1e-3 / 9.0)), 1e-9);
}
