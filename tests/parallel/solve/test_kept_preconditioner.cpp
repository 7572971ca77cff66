#include "support/pulled.hpp"
#include "support/springs.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// Particles clamped on the left and pulled on the right; below the diagonal, every third hangs on a spring that breaks
/// where the plate moves more than `limit`, ten in a pass on each rank.
struct HangingPlate {
  explicit HangingPlate(double limit, bool assembled = false,
                        options::KinematicsOption kinematics = options::KinematicsOption::small)
      : scene(options(kinematics), assembled)
  {
    const field::Rows& rows = scene.rows();
    for (Index row = 0; row < rows.owned(); ++row) {
      const Vector<2> x = scene.place(row);
      if (std::llround(40 * x.x()) % 3 == 0 && x.y() < x.x())
        springs.push_back({row, {1.0, 0.0}, 0.005, limit * (1.0 + 0.5 * x.y())});
    }
    scene.system().terms.push_back(std::make_unique<test::Springs>(springs));
  }
  void breakable() { scene.system().after.push_back(std::make_unique<test::SpringBreaker>(springs, rows().comm, 10)); }
  static options::SceneOptions options(options::KinematicsOption kinematics)
  {
    auto options = test::pulled_particles(40, {3e-2, 1e-2});
    options.kinematics = kinematics;
    return options;
  }
  const field::Rows& rows() { return scene.rows(); }
  double intact()
  {
    return scene.sum(static_cast<double>(
        std::count_if(springs.begin(), springs.end(), [](const test::Spring& s) { return !s.broken; })));
  }

  test::Scene scene;
  std::vector<test::Spring> springs;
};

struct Outcome {
  VecHandle u;
  solve::StaticReport report;
};

Outcome run(HangingPlate& plate, const solve::StaticOptions& options)
{
  Outcome outcome{plate.rows().vector(), {}};
  solve::StaticDriver driver(plate.scene.system(), options);
  driver.run(outcome.u.get(), [](const solve::Step&, Vec) { return solve::Verdict::go_on; });
  outcome.report = driver.report();
  return outcome;
}

double difference(const VecHandle& a, const VecHandle& b) { return test::difference(a.get(), b.get(), NORM_2); }

/// The same broken springs, solved from zero at full load to the relative tolerance.
VecHandle cold(const HangingPlate& broken, options::KinematicsOption kinematics)
{
  HangingPlate plate(0.0, false, kinematics);
  plate.springs = broken.springs;
  return run(plate, {}).u;
}

constexpr double kLimit = 5e-3; // some springs break, most do not [m]
} // namespace

TEST(KeptPreconditioner, ServesManyPassesAndEndsWhereAColdSolveEnds)
{
  HangingPlate plate(kLimit);
  plate.breakable();
  const double all = plate.intact();
  const Outcome kept = run(plate, {.load_steps = 3});
  EXPECT_LT(plate.intact(), all);
  EXPECT_GT(plate.intact(), 0.0);
  EXPECT_GE(kept.report.passes, 8);
  EXPECT_EQ(kept.report.preconditioner_builds, 1);
  // Nothing changed before the quiet passes: no tangent for the solve after them.
  EXPECT_EQ(kept.report.jacobian_assemblies, 1 + kept.report.passes - kept.report.steps);
  EXPECT_LT(difference(kept.u, cold(plate, options::KinematicsOption::small)), 1e-8);
}

TEST(KeptPreconditioner, IsBuiltAnewWhenIterationsGrow)
{
  HangingPlate plate(kLimit), eager(kLimit);
  plate.breakable();
  eager.breakable();
  const Outcome kept = run(plate, {.load_steps = 2});
  const Outcome built = run(eager, {.load_steps = 2, .rebuild_factor = 0.0});
  EXPECT_EQ(kept.report.preconditioner_builds, 1);
  EXPECT_GT(built.report.preconditioner_builds, 2);
  EXPECT_LE(built.report.preconditioner_builds, built.report.jacobian_assemblies);
  EXPECT_LT(difference(built.u, kept.u), 1e-8);
}

TEST(KeptPreconditioner, IsBuiltAnewAfterARestore)
{
  HangingPlate plate(kLimit);
  plate.breakable();
  const Outcome r = run(plate, {.load_steps = 1, .max_passes = 4, .max_halvings = 10});
  EXPECT_GT(r.report.halvings, 0);
  EXPECT_EQ(r.report.preconditioner_builds, 1 + r.report.halvings);
  EXPECT_LT(difference(r.u, cold(plate, options::KinematicsOption::small)), 1e-8);
}

TEST(KeptPreconditioner, NewtonKeepsItAndConverges)
{
  HangingPlate plate(kLimit, false, options::KinematicsOption::finite);
  plate.breakable();
  const Outcome kept = run(plate, {.load_steps = 2});
  EXPECT_GT(kept.report.passes, 4);
  EXPECT_LE(2 * kept.report.preconditioner_builds, kept.report.newton_iterations);
  EXPECT_LT(difference(kept.u, cold(plate, options::KinematicsOption::finite)), 1e-8);
}

TEST(KeptPreconditioner, AFactorThatIsTheSolverFollowsEveryChange)
{
  int ranks = 0;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const test::Option once("-ksp_type", "preonly"), factor("-pc_type", ranks > 1 ? "redundant" : "cholesky");
  HangingPlate plate(kLimit, true);
  plate.breakable();
  const Outcome r = run(plate, {.load_steps = 2, .assembled = true});
  EXPECT_GT(r.report.jacobian_assemblies, 3);
  EXPECT_EQ(r.report.preconditioner_builds, r.report.jacobian_assemblies);
  PDX_CALL(PetscOptionsClearValue(nullptr, "-ksp_type"));
  PDX_CALL(PetscOptionsClearValue(nullptr, "-pc_type"));
  EXPECT_LT(difference(r.u, cold(plate, options::KinematicsOption::small)), 1e-8);
}

TEST(Tolerance, WarmSolvesStopAtTheForceScaleOfTheLoad)
{
  HangingPlate plate(kLimit), strict(kLimit);
  plate.breakable();
  strict.breakable();
  const Outcome ours = run(plate, {.load_steps = 2});
  const test::Option relative("-ksp_rtol", "1e-10"); // of the residual each solve starts with
  const Outcome literal = run(strict, {.load_steps = 2});
  EXPECT_EQ(ours.report.solves, literal.report.solves);
  EXPECT_LT(ours.report.linear_iterations, literal.report.linear_iterations);
  EXPECT_LT(difference(ours.u, literal.u), 1e-8);
}
