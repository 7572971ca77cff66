#include "pdx/couple/fracture.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

namespace pdx::test {
namespace {
constexpr double kLimit = 0.02; // critical stretch [-]

/// A patch of 40 x 40 particles in a held plate.
options::SceneOptions breakable_plate(couple::Scheme scheme)
{
  options::SceneOptions options = with_patch(held_plate({10, 10}), {{0.3, 0.3}, {0.7, 0.7}}, 0.01);
  options.scheme = scheme;
  options.fracture.critical_stretch = kLimit;
  return options;
}

bool in_disc(const Vector<2>& x) { return (x - Vector<2>(0.5, 0.5)).norm() < 0.15; }

/// Breaks bonds of the disc as a shake would: those that noise of this size stretches or shortens too much.
void shake(Scene& scene, double size)
{
  for (const double sign : {1.0, -1.0})
    scene.d().fracture->apply(scene.blocks([=](const Vector<2>& x) -> Vector<2> {
      return in_disc(x) ? Vector<2>(sign * size * noise(5)(x)) : Vector<2>::Zero();
    }));
}

/// Mean damage of the particles of the disc.
double damage_in_disc(Scene& scene)
{
  const couple::ParticleDamage found = couple::particle_damage(scene.rows(), *scene.d().bonds, scene.d().carried);
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < scene.d().particles.size(); ++k)
    if (in_disc(scene.d().particles[k].x)) {
      sum += found.damage[k];
      count += 1.0;
    }
  return scene.sum(sum) / scene.sum(count);
}
} // namespace

// 20 % to all bonds of a disc: at the end its particles are alone.
TEST(HeavyDamage, SolvesInFewIterationsWhateverPartOfADiscIsBroken)
{
  struct Shake {
    double size, least, most; // [m], bounds of the mean damage
  };
  for (const couple::Scheme scheme : {couple::Scheme::energy, couple::Scheme::ghost})
    for (const Shake& s :
         {Shake{6e-4, 0.2, 0.5}, Shake{1.4e-3, 0.55, 0.7}, Shake{3e-3, 0.75, 0.9}, Shake{1.0, 0.99, 1.0}}) {
      Scene scene(breakable_plate(scheme));
      shake(scene, s.size);
      const double damage = damage_in_disc(scene);
      EXPECT_GT(damage, s.least);
      EXPECT_LE(damage, s.most);
      const std::int64_t broken = scene.d().fracture->broken();
      scene.prescribe(affine(1e-4, 0.0, 0.0, -3e-5));
      const VecHandle u = scene.solve();
      EXPECT_LE(scene.report().linear_iterations, damage < 0.95 ? 40 : 60) << damage;
      EXPECT_EQ(scene.d().fracture->broken(), broken);
      PetscReal largest = 0.0;
      PDX_CALL(VecNorm(u.get(), NORM_INFINITY, &largest));
      EXPECT_LT(largest, 2e-4); // nothing flies off
      if (s.size == 1.0) {
        EXPECT_GT(scene.report().held_rows, 500); // alone
      }
    }
}
} // namespace pdx::test
