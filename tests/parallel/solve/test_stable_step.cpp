#include "pdx/solve/stable_step.hpp"
#include "support/cracked.hpp"
#include "support/inert_term.hpp"
#include "support/ranks.hpp"

#include <gtest/gtest.h>

namespace pdx::test {
namespace {
constexpr double kDensity = 7.0; // [kg/m^3]

/// A plate that a slanted crack cuts through, with a patch around its middle.
options::SceneOptions cut_plate_with_patch(couple::Scheme scheme)
{
  options::SceneOptions options = with_patch(held_plate({10, 10}), {{0.3, 0.3}, {0.7, 0.7}}, 0.025);
  options.conditions.resize(1);
  options.elastic.density = kDensity;
  options.scheme = scheme;
  options.cracks.lines = {through_crack({0.51, 0.47}, 0.6)};
  return options;
}

double total_mass(Scene& scene)
{
  double mine = 0.0;
  for (const double m : solve::lumped_mass(scene.system())) mine += m;
  return scene.sum(mine);
}

TEST(StableStep, IsTheSameOnAnyNumberOfRanks)
{
  std::vector<options::SceneOptions> all{cut_plate_with_patch(couple::Scheme::energy),
                                         cut_plate_with_patch(couple::Scheme::ghost), held_particles(20)};
  all.push_back(all.front());
  all.back().pd.patches.clear(); // cut elements decide
  all.back().pd.spacing.clear();
  for (options::SceneOptions& options : all) {
    options.elastic.density = kDensity;
    Scene scene(options);
    const solve::StableStep found = solve::stable_step(scene.system());
    const auto on_one = [&](auto&& of) {
      return on_one_rank([&](MPI_Comm comm) {
        Scene whole(options, false, comm);
        return of(solve::stable_step(whole.system()));
      });
    };
    const double limit = on_one([](const solve::StableStep& step) { return step.limit; });
    EXPECT_NEAR(found.limit, limit, 1e-12 * limit);
    EXPECT_NEAR(found.place[0], on_one([](const solve::StableStep& step) { return step.place[0]; }), 1e-12);
    EXPECT_NEAR(found.place[1], on_one([](const solve::StableStep& step) { return step.place[1]; }), 1e-12);
  }
}

TEST(StableStep, RowsHoldTheWholeMass)
{
  for (const auto scheme : {couple::Scheme::energy, couple::Scheme::ghost}) {
    Scene scene(cut_plate_with_patch(scheme));
    EXPECT_NEAR(total_mass(scene), kDensity * plane_stress().thickness, 1e-13 * kDensity);
  }
}

TEST(StableStep, RefusesStiffnessWithoutMass)
{
  options::SceneOptions options = cut_plate_with_patch(couple::Scheme::energy);
  options.elastic.density = 0.0;
  Scene scene(options);
  try {
    (void)solve::stable_step(scene.system());
    FAIL();
  } catch (const SolverFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("no mass"), std::string::npos) << failure.what();
  }
}

TEST(StableStep, IsUnknownForTheInterfaceScheme)
{
  Scene scene(cut_plate_with_patch(couple::Scheme::interface));
  EXPECT_THROW((void)solve::stable_step(scene.system()), std::logic_error);
}

/// One row per rank, of mass 1, on a spring that is stiffer upwards.
struct OnSpring final : InertTerm {
  void add_mass(std::span<double> mass) const override { mass[0] += 1.0; }
  void add_stiffness_bound(std::span<double> blocks) const override
  {
    blocks[0] += 4.0;
    blocks[3] += 100.0;
  }
};

TEST(StableStep, HeldComponentsDoNotCount)
{
  const int ranks = test::ranks();
  for (const int held : {0, 1, 2}) {
    field::System system;
    system.rows = field::Rows::number(PETSC_COMM_WORLD, 2, 1, 0, 0);
    system.terms.push_back(std::make_unique<OnSpring>());
    system.coordinates = {0.5 * (ranks - system.rows.first), 3.0};
    if (held > 0) system.prescribed = {{1}, {0.0}};
    if (held > 1) system.prescribed = {{0, 1}, {0.0, 0.0}};
    system.bind();
    const solve::StableStep step = solve::stable_step(system);
    if (held == 2) {
      EXPECT_TRUE(std::isinf(step.limit));
      EXPECT_EQ(step.row, -1);
    } else {
      EXPECT_DOUBLE_EQ(step.limit, held ? 1.0 : 0.2);
      EXPECT_EQ(step.row, ranks - 1); // the lowest place
      EXPECT_DOUBLE_EQ(step.place[0], 0.5);
    }
  }
}
} // namespace
} // namespace pdx::test
