#include "support/scene.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace pdx::test::rigid_motion {
using couple::Scheme;

namespace {
constexpr Scheme kSchemes[] = {Scheme::energy, Scheme::ghost, Scheme::interface};

/// Two patches of different spacing in a plate.
options::SceneOptions plate(Scheme scheme, options::KinematicsOption kinematics)
{
  auto options = test::with_patch(test::held_plate({12, 10}, {{0.0, 0.0}, {1.2, 1.0}}), {{0.2, 0.3}, {0.5, 0.7}}, 0.05);
  options = test::with_patch(options, {{0.8, 0.4}, {1.0, 0.8}}, 0.025);
  options.scheme = scheme;
  options.kinematics = kinematics;
  return options;
}

/// Largest component of the internal force, over all ranks [N].
double largest_force(const test::Scene& scene, const test::Field& field)
{
  double most = 0.0;
  for (const double f : scene.internal_force(scene.blocks(field))) most = std::max(most, std::abs(f));
  return scene.max(most);
}
} // namespace

TEST(RigidMotion, TranslationCausesNoForce)
{
  for (const Scheme scheme : kSchemes)
    for (const auto kinematics :
         {options::KinematicsOption::small, options::KinematicsOption::finite, options::KinematicsOption::mixed}) {
      const test::Scene scene(plate(scheme, kinematics));
      // E t |u| = 3 * 0.5 * 0.5 N
      EXPECT_LT(largest_force(scene, test::affine(0.0, 0.0, 0.0, 0.0, {0.3, -0.4})), 1e-12);
      EXPECT_GT(largest_force(scene, test::affine(0.3, 0.0, 0.0, 0.0)), 1e-2);
    }
}

TEST(RigidMotion, SmallRotationCausesNoForceInSmallStrain)
{
  for (const Scheme scheme : kSchemes) {
    const test::Scene scene(plate(scheme, options::KinematicsOption::small));
    EXPECT_LT(largest_force(scene, test::affine(0.0, -0.5, 0.5, 0.0)), 1e-12);
  }
}

TEST(RigidMotion, FiniteRotationCausesNoForceInFiniteStrain)
{
  const double c = std::cos(std::numbers::pi / 6.0), s = std::sin(std::numbers::pi / 6.0);
  const auto turned = test::affine(c - 1.0, -s, s, c - 1.0, {0.2, 0.1});
  for (const Scheme scheme : kSchemes) {
    const test::Scene scene(plate(scheme, options::KinematicsOption::finite));
    EXPECT_LT(largest_force(scene, turned), 1e-12);
    EXPECT_LT(std::abs(scene.energy(scene.blocks(turned))), 1e-14);
    const test::Scene small(plate(scheme, options::KinematicsOption::small));
    EXPECT_GT(largest_force(small, turned), 1e-3);
  }
}

TEST(RigidMotion, ForcesOfAnyDeformationHaveNoResultant)
{
  const auto wild = test::noise(7);
  const test::Field deformation = [&](const Vector<2>& x) -> Vector<2> { return 5e-3 * wild(x); };
  for (const Scheme scheme : kSchemes)
    for (const auto kinematics : {options::KinematicsOption::small, options::KinematicsOption::finite}) {
      const test::Scene scene(plate(scheme, kinematics));
      const std::vector<double> force = scene.internal_force(scene.blocks(deformation));
      double size = 0.0, sum[3] = {0.0, 0.0, 0.0};
      for (Index row = 0; row < scene.rows().owned(); ++row) {
        const auto at = static_cast<std::size_t>(2 * row);
        const Vector<2> x = scene.place(row), f(force[at], force[at + 1]);
        size += f.cwiseAbs().sum();
        sum[0] += f.x();
        sum[1] += f.y();
        sum[2] += x.x() * f.y() - x.y() * f.x();
      }
      size = scene.sum(size);
      EXPECT_GT(size, 1e-3);
      EXPECT_LT(std::abs(scene.sum(sum[0])), 1e-13 * size);
      EXPECT_LT(std::abs(scene.sum(sum[1])), 1e-13 * size);
      // Moments balance about the reference places only where forces point along reference bonds.
      sum[2] = scene.sum(sum[2]);
      if (kinematics == options::KinematicsOption::small) {
        EXPECT_LT(std::abs(sum[2]), 1e-13 * size);
      }
    }
}
} // namespace pdx::test::rigid_motion
