#include "support/ranks.hpp"
#include "support/scene.hpp"
#include "support/springs.hpp"

#include <gtest/gtest.h>
#include <numeric>

namespace pdx::test::load_stepping {
namespace {
constexpr std::array<double, 2> kX{1.0, 0.0}, kY{0.0, 1.0};

/// One row for each rank under a force of 1 N along x: a spring of 1 N/m that lasts and four that break at the
/// stretches given, held in y.
std::vector<Spring> bundle(std::array<double, 4> limits, double lasting = 1.0)
{
  std::vector<Spring> springs{{0, kY, 1.0, kUnbreakable}, {0, kX, lasting, kUnbreakable}};
  for (const double limit : limits) springs.push_back({0, kX, 1.0, limit});
  return springs;
}

std::vector<double> values(Vec u)
{
  const double* at = nullptr;
  PetscInt n = 0;
  PDX_CALL(VecGetLocalSize(u, &n));
  PDX_CALL(VecGetArrayRead(u, &at));
  std::vector<double> copy(at, at + n);
  PDX_CALL(VecRestoreArrayRead(u, &at));
  return copy;
}

struct Outcome {
  std::vector<solve::Step> steps;
  std::vector<std::vector<double>> states;
  std::vector<double> end;
  std::string failure;
  solve::StaticReport report;
};

Outcome run(const field::System& system, const solve::StaticOptions& options)
{
  const test::Option jacobi("-pc_type", "jacobi");
  Outcome run;
  solve::StaticDriver driver(system, options);
  const VecHandle u = system.rows.vector();
  try {
    driver.run(u.get(), [&](const solve::Step& step, Vec state) {
      run.steps.push_back(step);
      run.states.push_back(values(state));
      return solve::Verdict::go_on;
    });
  } catch (const SolverFailure& failure) {
    run.failure = failure.what();
  }
  run.end = values(u.get());
  run.report = driver.report();
  return run;
}

int broken(const std::vector<Spring>& springs)
{
  return static_cast<int>(std::count_if(springs.begin(), springs.end(), [](const Spring& s) { return s.broken; }));
}
} // namespace

// Load 1/2: u = 0.5/5 = 0.1. Load 1: u = 0.2 breaks the first; 1/4 = 0.25 breaks the second; 1/3 rests.
TEST(LoadStepping, SolvesAgainUntilAllAreQuiet)
{
  test::SpringBed bed(1, {1.0, 0.0}, bundle({0.19, 0.24, 0.34, 0.6}));
  bed.breakable();
  const Outcome r = run(bed.system, {2});
  EXPECT_EQ(r.failure, "");
  ASSERT_EQ(r.steps.size(), 2u);
  EXPECT_EQ((std::array{r.steps[0].passes, r.steps[1].passes}), (std::array{1, 3}));
  EXPECT_EQ(r.steps[0].changes, 0);
  EXPECT_EQ(r.steps[1].changes, 2 * ranks());
  EXPECT_EQ((std::array{r.steps[0].load, r.steps[1].load}), (std::array{0.5, 1.0}));
  EXPECT_NEAR(r.states[0][0], 0.1, 1e-12);
  EXPECT_NEAR(r.end[0], 1.0 / 3, 1e-12);
  EXPECT_EQ(r.report.solves, 4);
  EXPECT_EQ(r.report.passes, 4);
  EXPECT_EQ(r.report.halvings, 0);
  EXPECT_EQ(r.report.jacobian_assemblies, 3); // the first, and after each of the two passes that broke something
  EXPECT_EQ(r.report.solve_iterations.size(), 4u);
  EXPECT_EQ(r.report.solve_changes, (std::vector<std::int64_t>{0, ranks(), ranks(), 0}));
  EXPECT_NEAR(std::accumulate(r.report.solve_seconds.begin(), r.report.solve_seconds.end(), 0.0), r.report.seconds,
              1e-12);
}

// They break one by one at loads (those left, the lasting one included) x limit: 0.15, 0.4, 0.6, 0.7.
TEST(LoadStepping, IncrementsThatChangeTooMuchAreHalvedAndGrowBack)
{
  test::SpringBed bed(1, {1.0, 0.0}, bundle({0.03, 0.1, 0.2, 0.35}));
  bed.breakable();
  const Outcome r = run(bed.system, {.load_steps = 1, .max_changes = ranks()});
  EXPECT_EQ(r.failure, "");
  EXPECT_NEAR(r.end[0], 1.0, 1e-12); // the lasting spring alone
  std::int64_t changes = 0;
  double load = 0.0;
  for (const solve::Step& step : r.steps) {
    EXPECT_LE(step.changes, ranks());
    EXPECT_GT(step.load, load);
    load = step.load;
    changes += step.changes;
  }
  EXPECT_EQ(changes, 4 * ranks());
  EXPECT_EQ(load, 1.0);
  EXPECT_GE(r.report.halvings, 2);
  EXPECT_EQ(r.report.steps, static_cast<int>(r.steps.size()));
}

// Without a lasting spring the bundle bears max (number left) x limit = 2 x 0.31 = 0.62.
TEST(LoadStepping, UnstableGrowthKeepsWhatWasAccepted)
{
  test::SpringBed bed(1, {1.0, 0.0}, bundle({0.1, 0.2, 0.31, 0.31}, 0.0));
  bed.breakable();
  const Outcome r = run(bed.system, {.load_steps = 4, .max_halvings = 5});
  EXPECT_NE(r.failure.find("unstable growth"), std::string::npos) << r.failure;
  EXPECT_NE(r.failure.find("load step 3 of 4 failed at load 0.62"), std::string::npos) << r.failure;
  ASSERT_FALSE(r.steps.empty());
  EXPECT_LE(r.steps.back().load, 0.62);
  EXPECT_GT(r.steps.back().load, 0.62 - 0.25 / 32);
  EXPECT_EQ(r.end, r.states.back()); // bit by bit
  EXPECT_EQ(broken(bed.springs), 2);
}

TEST(LoadStepping, RejectedIncrementsLeaveNoTrace)
{
  // Load 1 stretches all by 1/5, so each attempt above 0.755 breaks four.
  test::SpringBed bed(1, {1.0, 0.0}, bundle({0.151, 0.151, 0.151, 0.151}));
  bed.breakable();
  const Outcome r = run(bed.system, {.load_steps = 1, .max_changes = 3 * ranks(), .max_halvings = 3});
  EXPECT_EQ(r.steps.back().load, 0.75); // the next is 0.875
  EXPECT_EQ(broken(bed.springs), 0);
  EXPECT_EQ(r.end, r.states.back());
  EXPECT_NE(r.failure.find("more than"), std::string::npos) << r.failure;
}

TEST(LoadStepping, TooManyPassesAreHalved)
{
  test::SpringBed bed(1, {1.0, 0.0}, bundle({0.03, 0.1, 0.2, 0.35}));
  bed.breakable();
  const Outcome r = run(bed.system, {.load_steps = 1, .max_passes = 2});
  EXPECT_EQ(r.failure, "");
  EXPECT_GT(r.report.halvings, 0);
  for (const solve::Step& step : r.steps) EXPECT_LE(step.passes, 2);
  EXPECT_EQ(broken(bed.springs), 4);
}

TEST(LoadStepping, LinearFailureWithoutChangesIsNotTriedAtHalfTheLoad)
{
  const test::Option few("-ksp_max_it", "1");
  test::SpringBed bed(3, {1.0, 0.5},
                      {{0, kX, 1.0, kUnbreakable},
                       {0, kY, 2.0, kUnbreakable},
                       {0, {0.6, 0.8}, 3.0, kUnbreakable},
                       {1, kX, 4.0, kUnbreakable},
                       {1, kY, 5.0, kUnbreakable},
                       {1, {0.8, 0.6}, 7.0, kUnbreakable},
                       {2, kX, 1.0, kUnbreakable},
                       {2, kY, 9.0, kUnbreakable},
                       {2, {0.8, -0.6}, 7.0, kUnbreakable}});
  const Outcome r = run(bed.system, {2});
  EXPECT_NE(r.failure.find("load step 1 of 2"), std::string::npos) << r.failure;
  EXPECT_EQ(r.report.solves, 1);
  EXPECT_EQ(r.report.halvings, 0);
}

// Row 0 has one spring along (0.6, 0.8), row 1 none, row 2 two: held in one, two and no directions.
TEST(WeakRows, AreHeldWhereTheyHaveNoStiffness)
{
  test::SpringBed bed(3, {0.0, 1.0},
                      {{0, {0.6, 0.8}, 2.0, kUnbreakable}, {2, kX, 3.0, kUnbreakable}, {2, kY, 4.0, kUnbreakable}});
  bed.system.scale = 10.0;
  bed.term->weak = {0, 1, 2, 1};
  bed.term->report_weak = true;
  const std::vector<double> expected[2] = {{2 * 0.36 + 10 * 0.64, 2 * 0.48 - 10 * 0.48, 10, 0, 3, 0},
                                           {2 * 0.48 - 10 * 0.48, 2 * 0.64 + 10 * 0.36, 0, 10, 0, 4}};
  for (const bool assembled : {false, true}) {
    solve::TangentOperator tangent(bed.system, assembled);
    const std::vector<double> zero(6, 0.0);
    for (int times = 0; times < 2; ++times) tangent.update(zero);
    EXPECT_EQ(tangent.held_rows(), 2 * ranks());
    for (const PetscInt a : {0, 1}) {
      const VecHandle x = bed.system.rows.vector(), y = bed.system.rows.vector();
      PDX_CALL(VecStrideSet(x.get(), a, 1.0));
      PDX_CALL(MatMult(tangent.matrix(), x.get(), y.get()));
      const std::vector<double> found = values(y.get());
      for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(found[k], expected[a][k], 1e-13) << a << k;
    }
  }
  // The force (0, 1) on row 0 has 0.8 along its spring; row 1 stays.
  const Outcome r = run(bed.system, {3});
  EXPECT_EQ(r.failure, "");
  const std::vector<double> u{0.4 * 0.6, 0.4 * 0.8, 0.0, 0.0, 0.0, 0.25};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(r.end[k], u[k], 1e-13) << k;
  EXPECT_EQ(r.report.held_rows, 2 * ranks());
}

TEST(WeakRows, ARowThatComesLooseOnTheWayStays)
{
  test::SpringBed bed(2, {1.0, 0.0},
                      {{0, kX, 1.0, 0.5}, {0, kY, 1.0, 0.5}, {1, kX, 1.0, kUnbreakable}, {1, kY, 1.0, kUnbreakable}});
  bed.breakable();
  bed.term->weak = {0};
  bed.term->report_weak = true;
  const Outcome r = run(bed.system, {4});
  EXPECT_EQ(r.failure, "");
  EXPECT_EQ(broken(bed.springs), 1);
  EXPECT_NEAR(r.end[0], 0.75, 1e-13); // where it was when its spring broke
  EXPECT_NEAR(r.end[2], 1.0, 1e-13);
}
} // namespace pdx::test::load_stepping
