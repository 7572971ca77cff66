#include "pdx/solve/kept_momentum.hpp"

#include "support/scene.hpp"
#include "support/standing_wave.hpp"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// A plate of 12 x 12 elements, free in space, with a patch and perhaps a crack.
options::SceneOptions flying_plate(bool cracked)
{
  options::SceneOptions options = test::held_plate({12, 12});
  options.conditions.clear();
  options = test::moving(test::with_patch(std::move(options), {{0.25, 0.25}, {0.75, 0.75}}, 1.0 / 48.0));
  if (cracked) options.cracks.lines = {{{0.0, 0.46}, {0.5, 0.52}}};
  return options;
}

std::vector<double> owned_of(const test::Scene& scene, const test::Field& field)
{
  std::vector<double> all = scene.blocks(field);
  all.resize(2 * static_cast<std::size_t>(scene.rows().owned()));
  return all;
}

/// What momentum is missing after a change, over that of the largest velocity.
double missing(bool cracked)
{
  test::Scene scene(flying_plate(cracked));
  const solve::MovingSystem moving(scene.system());
  const auto right = [](const Vector<2>& x) { return x[0] > 0.4; };
  std::vector<Index> is_new;
  for (Index row = 0; row < scene.rows().owned(); ++row)
    if (right(scene.place(row))) is_new.push_back(row);
  const auto wanted = moving.momentum(owned_of(scene, test::noise(3)));
  std::vector<double> v = owned_of(scene, test::noise(5));
  const std::vector<double> before = v;
  solve::keep_momentum(moving, is_new, wanted, v);
  for (Index row = 0; row < scene.rows().owned(); ++row)
    if (!std::ranges::binary_search(is_new, row)) {
      const auto k = 2 * static_cast<std::size_t>(row);
      EXPECT_EQ(v[k], before[k]);
    }
  const auto found = moving.momentum(v), whole = moving.momentum(owned_of(scene, test::affine(0, 0, 0, 0, {1.0, 1.0})));
  EXPECT_NEAR(whole[0], 0.5, 0.01); // rho 1, thickness 0.5, and sets that move
  EXPECT_GT(std::abs(wanted[0] - moving.momentum(before)[0]), 1e-4 * whole[0]);
  return std::max(std::abs(found[0] - wanted[0]), std::abs(found[1] - wanted[1])) / whole[0];
}
} // namespace

TEST(KeptMomentum, IsThatOfBeforeToRounding)
{
  EXPECT_LT(missing(false), 1e-15);
  EXPECT_LT(missing(true), 1e-15);
}

namespace {
/// What angular momentum, and what momentum, is missing after a change, over those of the largest velocity.
std::array<double, 2> missing_spin(bool cracked)
{
  test::Scene scene(flying_plate(cracked));
  const solve::MovingSystem moving(scene.system());
  std::vector<Index> is_new;
  for (Index row = 0; row < scene.rows().owned(); ++row)
    if (scene.place(row)[0] > 0.4) is_new.push_back(row);
  const std::vector<double> u = owned_of(scene, [](const Vector<2>& x) { return 1e-2 * test::noise(2)(x); });
  const std::vector<double> before = owned_of(scene, test::noise(3));
  const auto momentum = moving.momentum(before);
  const Vector<3> wanted = solve::angular_momentum(moving, u, before);
  std::vector<double> v = owned_of(scene, test::noise(5));
  solve::keep_momentum(moving, is_new, momentum, v);
  const Vector<3> found = solve::angular_momentum(moving, u, v);
  EXPECT_GT((found - wanted).norm(), 1e-4);
  solve::keep_angular_momentum(moving, is_new, wanted, u, v);
  const auto now = moving.momentum(v);
  return {(solve::angular_momentum(moving, u, v) - wanted).norm(),
          std::max(std::abs(now[0] - momentum[0]), std::abs(now[1] - momentum[1]))};
}
} // namespace

// Of a body of mass 1/2 and side 1.
TEST(KeptMomentum, TurnsWhatIsNewByWhatIsMissing)
{
  for (const bool cracked : {false, true}) {
    const auto [spin, momentum] = missing_spin(cracked);
    EXPECT_LT(spin, 1e-14);
    EXPECT_LT(momentum, 1e-14);
  }
}

// A rigid turn by hand: a square of side a and mass m about its corner has m (a^2/6 + a^2/2) omega.
TEST(KeptMomentum, AngularMomentumOfAPlateThatTurns)
{
  test::Scene scene(flying_plate(false));
  const solve::MovingSystem moving(scene.system());
  const std::vector<double> rest(moving.owned(), 0.0);
  const double found = solve::angular_momentum(moving, rest, owned_of(scene, test::affine(0.0, -3.0, 3.0, 0.0)))[2];
  const double h = 1.0 / 12.0, lumped = 0.5 * 3.0 * (2.0 / 3.0 + h * h / 3.0); // nodes for bulk: h^2/3 more
  EXPECT_NEAR(found, lumped, 0.25 * 0.5 * 3.0 * h * h / 3.0 + 1e-3);
  EXPECT_LT(found, lumped);
}

TEST(KeptMomentum, IsLeftAloneWhereNothingIsNew)
{
  test::Scene scene(flying_plate(false));
  const solve::MovingSystem moving(scene.system());
  std::vector<double> v = owned_of(scene, test::noise(5));
  const std::vector<double> before = v;
  solve::keep_momentum(moving, {}, {1.0, 1.0, 0.0}, v);
  EXPECT_EQ(v, before);
}
