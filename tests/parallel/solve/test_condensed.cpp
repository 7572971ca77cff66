#include "pdx/solve/static_solver.hpp"
#include "support/pulled.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
options::SceneOptions plate_with_patch(couple::Scheme scheme = couple::Scheme::energy)
{
  options::SceneOptions options = test::with_patch(test::held_plate({12, 12}), {{0.25, 0.25}, {0.75, 0.75}}, 1.0 / 36);
  options.scheme = scheme;
  return options;
}

/// Cracked from the left through elements into the patch, held on the left and pulled, a load on the right.
options::SceneOptions cracked_plate()
{
  options::SceneOptions options = plate_with_patch();
  options.cracks.lines = {{{0.0, 0.52}, {0.5, 0.52}}};
  options.conditions.resize(1); // left
  options.conditions.push_back(test::pull("right", {1e-2, 2e-2}));
  return options;
}

struct CondensedRun {
  VecHandle u;
  std::vector<double> force; // unbalanced, where free and where held [N]
  solve::CondensationReport told;
  solve::StaticReport report;
};

CondensedRun solve_by(test::Scene& scene, solve::Condense condense, int load_steps = 2)
{
  CondensedRun solved;
  solved.u = scene.rows().vector();
  solve::StaticSolver solver(scene.system(), {.load_steps = load_steps, .condense = condense});
  solver.run(solved.u.get(), [](const solve::Step&, Vec) { return solve::Verdict::go_on; });
  solved.force = solver.unbalanced_force(solved.u.get(), 1.0);
  solved.told = solver.condensation();
  solved.report = solver.report();
  return solved;
}

std::string why_not(test::Scene& scene, solve::Condense condense, int load_steps)
{
  return solve::StaticSolver(scene.system(), {.load_steps = load_steps, .condense = condense}).condensation().why_not;
}

/// Largest unbalanced force of what is free over the largest reaction.
double imbalance(test::Scene& scene, const std::vector<double>& force)
{
  double free = 0.0, held = 0.0;
  for (std::size_t k = 0; k < force.size(); ++k) {
    double& largest = scene.system().held[k] ? held : free;
    largest = std::max(largest, std::abs(force[k]));
  }
  return scene.max(free) / scene.max(held);
}

void expect_same(options::SceneOptions options, const test::Field& moved, const test::Field& load)
{
  test::Scene scene(std::move(options));
  scene.prescribe(moved);
  scene.load(load);
  const CondensedRun whole = solve_by(scene, solve::Condense::off), condensed = solve_by(scene, solve::Condense::on);
  EXPECT_EQ(whole.told.why_not, "-static_condense off");
  EXPECT_EQ(condensed.told.why_not, "");
  EXPECT_GT(condensed.told.eliminated, 0);
  EXPECT_LT(imbalance(scene, condensed.force), 1e-8);
  EXPECT_LT(test::difference(condensed.u.get(), whole.u.get(), NORM_INFINITY), 1e-8);
}
const test::Field kNothing = test::affine(0.0, 0.0, 0.0, 0.0);
} // namespace

TEST(Condensed, EvenStrainStaysEven)
{
  test::Scene scene(plate_with_patch());
  const test::Field even = test::affine(1e-3, 4e-4, -2e-4, -5e-4, {1e-4, 2e-4});
  scene.prescribe(even);
  const CondensedRun solved = solve_by(scene, solve::Condense::on);
  EXPECT_EQ(solved.told.why_not, "");
  // All nodes but those of the elements beside the patch: its corners are 3 and 9 of 12 elements from the corner.
  const double nodes = scene.sum(static_cast<double>(scene.rows().nodes));
  EXPECT_EQ(static_cast<double>(solved.told.kept + solved.told.eliminated), 2.0 * nodes);
  EXPECT_LE(solved.told.kept, 2 * (11 * 11 - 5 * 5));
  EXPECT_LT(scene.max_error(solved.u.get(), even), 1e-8);
}

TEST(Condensed, LoadsAndMovedSidesAsWithoutIt)
{
  expect_same(plate_with_patch(), test::noise(3), test::noise(4));
  expect_same(plate_with_patch(couple::Scheme::ghost), test::noise(5), test::noise(6));
}

TEST(Condensed, CracksInElementsAsWithoutIt)
{
  expect_same(cracked_plate(), kNothing, kNothing);
  expect_same(cracked_plate(), test::noise(7), test::noise(8));
}

TEST(Condensed, TakesNoMoreIterations)
{
  test::Scene scene(cracked_plate());
  const CondensedRun whole = solve_by(scene, solve::Condense::off), condensed = solve_by(scene, solve::Condense::on);
  EXPECT_LE(condensed.report.linear_iterations, whole.report.linear_iterations);
}

TEST(Condensed, AsksForManySolvesAndALinearSymmetricScene)
{
  test::Scene scene(cracked_plate()), unsymmetric(plate_with_patch(couple::Scheme::interface));
  EXPECT_EQ(why_not(scene, solve::Condense::automatic, 1), "too few solves to repay it");
  EXPECT_EQ(why_not(scene, solve::Condense::automatic, 4), "");
  EXPECT_EQ(why_not(unsymmetric, solve::Condense::automatic, 4), "the tangent is not symmetric");
  EXPECT_THROW(why_not(unsymmetric, solve::Condense::on, 4), UserError);
  options::SceneOptions finite = plate_with_patch();
  finite.kinematics = options::KinematicsOption::finite;
  test::Scene nonlinear(finite);
  EXPECT_EQ(why_not(nonlinear, solve::Condense::automatic, 4), "no elements of small strain");
}
