#include "support/cracked.hpp"

#include <gtest/gtest.h>

namespace pdx::test::runs_of_scenes {
namespace {
constexpr double kEqual = 1e-13; // of the largest force

options::SceneOptions plate(const geom::Box<2>& patch, double dx,
                            options::KinematicsOption kinematics = options::KinematicsOption::finite)
{
  auto options = test::with_patch(test::held_plate({16, 16}), patch, dx);
  options.kinematics = kinematics;
  options.pd.horizon_ratio = 3.0;
  return options;
}
const geom::Box<2> kMiddle{{0.25, 0.25}, {0.75, 0.75}};

/// Forces of carried bonds on the owned rows.
std::vector<double> forces(const Scene& scene, const couple::CarriedBonds<2>& bonds, std::span<const double> u)
{
  std::vector<double> r(static_cast<std::size_t>(2 * scene.rows().owned()), 0.0);
  bonds.add_residual(u, r);
  return r;
}

/// Strained and shaken by `amplitude`, the same on any number of ranks.
std::vector<double> shaken(const Scene& scene, double amplitude)
{
  return scene.blocks([amplitude](const Vector<2>& x) -> Vector<2> {
    return amplitude * (test::noise(5)(x) / 32.0 + Vector<2>(0.3 * x.x() + 0.1 * x.y(), -0.2 * x.y()));
  });
}

/// Between the forces by index, one bond for itself, and those of explicit steps, at small stretches, at large ones,
/// and after bonds broke.
double difference(const options::SceneOptions& options)
{
  Scene scene(options);
  couple::CarriedBonds<2>& bonds = *scene.d().carried;
  const std::vector<pd::BreakRule> rules(scene.plan().shapes.size(), {options.bond_kinematics(), 0.02, nullptr});
  const std::vector<double> small = shaken(scene, 1e-4), large = shaken(scene, 0.05);
  std::vector<std::vector<double>> before, after;
  std::vector<double> energy_before, energy_after;
  std::vector<bool> seen_before, seen_after;
  const auto look = [&](std::vector<std::vector<double>>& found, std::vector<bool>& seen, std::vector<double>& energy) {
    for (const auto* u : {&small, &large, &small}) {
      energy.push_back(scene.sum(bonds.energy(*u)));
      found.push_back(forces(scene, bonds, *u));
      seen.push_back(bonds.overstretched_seen());
    }
  };
  const auto broken = [&] { return scene.sum(static_cast<double>(bonds.break_bonds(large, rules).bonds)); };
  bonds.watch(rules);
  bonds.save();
  look(before, seen_before, energy_before);
  const double few = broken();
  EXPECT_GT(few, 0.0);
  EXPECT_GT(scene.sum(static_cast<double>(bonds.bonds())), 0.0);
  look(before, seen_before, energy_before);
  bonds.restore();
  bonds.step_explicitly();
  look(after, seen_after, energy_after);
  EXPECT_EQ(broken(), few);
  look(after, seen_after, energy_after);
  EXPECT_EQ(seen_before, seen_after);
  double worst = 0.0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    EXPECT_NEAR(energy_after[k], energy_before[k], kEqual * energy_before[k]);
    double apart = 0.0, largest = 0.0;
    for (std::size_t c = 0; c < before[k].size(); ++c) {
      apart = std::max(apart, std::abs(after[k][c] - before[k][c]));
      largest = std::max(largest, std::abs(before[k][c]));
    }
    worst = std::max(worst, scene.max(apart) / scene.max(largest));
  }
  return worst;
}
} // namespace

TEST(RunsOfScenes, HaveTheForcesOfBondsByIndex)
{
  for (const double spacings : {1.0, 2.0, 2.5, 4.0})
    for (const auto kinematics : {options::KinematicsOption::small, options::KinematicsOption::finite})
      EXPECT_LE(difference(plate(kMiddle, 0.0625 / spacings, kinematics)), kEqual) << spacings;
}

TEST(RunsOfScenes, HaveThemInOtherShapesAndAtFreeSides)
{
  auto steps = plate({{0.25, 0.25}, {0.5, 0.75}}, 1.0 / 64);
  steps.pd.patches.push_back({{0.5, 0.375}, {0.625, 0.625}});
  EXPECT_LE(difference(steps), kEqual);
  auto free = plate({{0.25, 0.0}, {0.75, 0.5}}, 1.0 / 64);
  std::erase_if(free.conditions, [](const auto& c) { return c.on == "bottom"; });
  EXPECT_LE(difference(free), kEqual);
  auto other = plate(kMiddle, 1.0 / 32);
  other.pd.horizon_ratio = 5.0;
  other.pd.micromodulus = law::Micromodulus::uniform;
  EXPECT_LE(difference(other), kEqual);
  auto ghosts = plate(kMiddle, 1.0 / 64);
  ghosts.scheme = couple::Scheme::ghost;
  EXPECT_LE(difference(ghosts), kEqual);
}

TEST(RunsOfScenes, HaveThemWhereACrackEntersAndBondsMayNotFail)
{
  auto cracked = plate(kMiddle, 1.0 / 64);
  cracked.cracks.lines = {through_crack({0.5, 0.51}, 0.1)};
  cracked.fracture.no_fail = {{{0.2, 0.2}, {0.4, 0.3}}};
  EXPECT_LE(difference(cracked), kEqual);
}
} // namespace pdx::test::runs_of_scenes
