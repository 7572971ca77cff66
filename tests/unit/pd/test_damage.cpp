#include "pdx/pd/breaker.hpp"
#include "pdx/pd/damage.hpp"
#include "window.hpp"

#include <gtest/gtest.h>

namespace {
using namespace pdx;
using test::Window;

/// Bonded volume by pairs.
template <int Dim> std::vector<double> by_pairs(const Window<Dim>& window)
{
  std::vector<double> sum(window.particles.size(), 0.0);
  for (const auto& pair : window.pairs)
    for (const auto& arm : window.stencil.half)
      if ((pair.xi - arm.xi).norm() < 1e-6 * arm.length) {
        sum[pair.i] += arm.volume_share * window.volume();
        sum[pair.j] += arm.volume_share * window.volume();
      }
  return sum;
}
template <int Dim> std::vector<double> bonded(const Window<Dim>& window)
{
  const auto spread = window.spread(std::vector<double>(window.particles.size() * Dim, 0.0));
  std::vector<double> sum(window.particles.size(), 0.0);
  pd::add_bonded_volume<Dim>(window.view(spread), window.stencil, window.runs, sum.data());
  return sum;
}

template <int Dim> void expect_as_pairs(const Window<Dim>& window)
{
  const std::vector<double> sum = bonded(window), reference = by_pairs(window);
  for (std::size_t k = 0; k < sum.size(); ++k) ASSERT_NEAR(sum[k], reference[k], 1e-12 * window.volume()) << k;
}

TEST(Damage, BondedVolumeEqualsALoopOverPairs)
{
  expect_as_pairs(Window<2>({20, 10}, {.ratio = 4.0, .missing = 0.1, .broken = 0.3}));
  expect_as_pairs(Window<2>({20, 14}, {6.5, law::Micromodulus::uniform, 0.05, 0.3, false}));
  expect_as_pairs(Window<3>({12, 7, 7}, {.ratio = 3.0, .missing = 0.1, .broken = 0.3}));
}

TEST(Damage, CountsThePrecrackSeparately)
{
  const pd::BondedVolume volume{8.0, 6.0, 3.0};
  EXPECT_DOUBLE_EQ(pd::damage(volume), 0.375);
  EXPECT_DOUBLE_EQ(pd::precrack_share(volume), 0.25);
  EXPECT_EQ(pd::damage({8.0, 6.0, 6.0}), 0.0);
  EXPECT_EQ(pd::damage({8.0, 8.0, 0.0}), 1.0);
  EXPECT_EQ(pd::damage({0.0, 0.0, 0.0}), 0.0);
  EXPECT_EQ(pd::precrack_share({0.0, 0.0, 0.0}), 0.0);
}

// Beside a crack between two rows, m = 3 conical: a particle loses (0, 1), (+-1, 1), (+-2, 1), (0, 2), (+-1, 2) and
// (+-2, 2); beta is 1 but for the last two, 3.5 - sqrt 8. Of its bonds, 20 have beta 1 and 4 that of (2, 2).
TEST(Damage, OfAStraightCrackIsAsByHand)
{
  Window<2> window({16, 12}, {.ratio = 3.0});
  const double y = (window.stencil.reach + 6) * window.kDx, corner = 3.5 - std::sqrt(8.0);
  const std::vector<double> whole = bonded(window);
  pd::cut_bonds<2>(crack::CrackSet({{{-1.0, y}, {1.0, y}}}, geom::Box<2>{{-2.0, -2.0}, {2.0, 2.0}}),
                   {window.sites, {}, window.sites.count}, window.stencil, window.runs,
                   {window.words[0].data(), window.words[1].data()});
  const std::vector<double> now = bonded(window);
  const auto phi = [&](Index i, Index j) {
    const std::size_t row = static_cast<std::size_t>(j * 16 + i);
    return pd::damage({whole[row], whole[row], now[row]});
  };
  const double family = 20.0 + 4.0 * corner;
  EXPECT_NEAR(phi(8, 6), (8.0 + 2.0 * corner) / family, 1e-12);
  EXPECT_NEAR(phi(8, 5), (8.0 + 2.0 * corner) / family, 1e-12);
  EXPECT_NEAR(phi(8, 7), (3.0 + 2.0 * corner) / family, 1e-12);
  EXPECT_EQ(phi(8, 8), 0.0);
}
} // namespace
