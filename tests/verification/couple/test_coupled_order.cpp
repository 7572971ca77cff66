#include "support/manufactured.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// Error in L2 of a plate of n x n cells under the solid's body force, its middle a patch of particles at h / 2.
double error_of(Index n, couple::Scheme scheme)
{
  auto options = test::with_patch(test::held_plate({n, n}), {{0.25, 0.25}, {0.75, 0.75}}, 0.5 / n);
  options.scheme = scheme;
  test::Scene scene(options);
  const test::Manufactured solid{options.elastic};
  scene.load([&](const Vector<2>& x) { return solid.body_force(x); });
  scene.prescribe(test::Manufactured::displacement);
  return scene.l2_error(scene.solve().get(), test::Manufactured::displacement);
}

/// On 8, 16, 32, 64 cells per side.
std::array<double, 4> errors(couple::Scheme scheme)
{
  std::array<double, 4> found{};
  for (std::size_t k = 0; k < found.size(); ++k) found[k] = error_of(8 << k, scheme);
  return found;
}
} // namespace

TEST(CoupledOrder, EnergySchemeIsOfSecondOrder)
{
  const auto e = errors(couple::Scheme::energy);
  EXPECT_GT(e[0], 1e-3); // no error at all would mean that nothing was measured
  for (std::size_t k = 1; k < e.size(); ++k) EXPECT_GE(std::log2(e[k - 1] / e[k]), 1.9) << (8 << k) << " cells a side";
}

TEST(CoupledOrder, InterfaceSchemeIsOfSecondOrder)
{
  const auto e = errors(couple::Scheme::interface);
  for (std::size_t k = 1; k < e.size(); ++k) EXPECT_GE(std::log2(e[k - 1] / e[k]), 1.9) << (8 << k) << " cells a side";
}

// Crossing bonds act in full beside full elements: an error in a layer of the width of a horizon.
TEST(CoupledOrder, GhostSchemeIsOfFirstOrder)
{
  const auto e = errors(couple::Scheme::ghost);
  EXPECT_NEAR(std::log2(e[2] / e[3]), 1.1, 0.15);
}
