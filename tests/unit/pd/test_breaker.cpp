#include "pdx/pd/breaker.hpp"
#include "window.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <set>
#include <tuple>

namespace {
using namespace pdx;
using law::Kinematics;
using test::at;
using test::Window;

template <int Dim> pd::BondWords writable(Window<Dim>& window)
{
  return {window.words[0].data(), window.words[1].data()};
}

/// Three particles in a row, 2 m apart, with one half arm to the right; the outermost sites are padding.
struct Chain {
  std::vector<double> u[2] = {std::vector<double>(5, 0.0), std::vector<double>(5, 0.0)};
  std::vector<std::uint64_t> word{0, 1, 1, 0, 0};
  std::vector<pd::HalfArm<2>> arms{{1, {2.0, 0.0}, 2.0, 7.0}};
  std::vector<pd::Run> runs{{1, 0, 3, pd::RunKind::partial}};
  pd::BondView<2> view() const
  {
    pd::BondView<2> v;
    v.u = {u[0].data(), u[1].data()};
    v.words = {word.data(), nullptr};
    v.arms = arms;
    return v;
  }
  std::int64_t break_at(pd::BreakRule rule) { return pd::break_bonds<2>(view(), runs, rule, {word.data(), nullptr}); }
};

TEST(Breaker, BreaksWhatIsStretchedBeyondTheCriticalStretch)
{
  Chain chain;
  chain.u[0] = {0.0, 0.0, 0.02, 0.06, 0.0}; // s = 0.01 and 0.02
  EXPECT_EQ(chain.break_at({Kinematics::finite, 0.021}), 0);
  EXPECT_EQ(chain.break_at({Kinematics::finite, 0.015}), 1);
  EXPECT_EQ(chain.word, (std::vector<std::uint64_t>{0, 1, 0, 0, 0}));
  EXPECT_EQ(pd::count_bonds(chain.view(), std::span<const pd::Run>(chain.runs)), 1);
  EXPECT_EQ(chain.break_at({Kinematics::finite, 0.015}), 0); // once
  EXPECT_EQ(chain.break_at({Kinematics::small, 0.005}), 1);
  EXPECT_EQ(chain.word, std::vector<std::uint64_t>(5, 0));
}

TEST(Breaker, BondsOfRegionsHaveTheirOwnCriticalStretch)
{
  law::Elastic solid;
  solid.young = 1.0;
  const law::Interface strong{1, 0, 72.0}; // sqrt(72 / 8) = 3 times the stretch; in a sqrt(2 / 8) of it
  const law::Regions regions(solid, 8.0, 8.0, {{"a", {}, solid, 2.0}}, {&strong, 1});
  const std::vector<std::uint8_t> region{0, 1, 1, 0, 0};
  for (const auto kinematics : {Kinematics::finite, Kinematics::small}) {
    Chain chain;
    chain.u[0] = {0.0, 0.0, 0.02, 0.06, 0.0}; // s = 0.01 in a, 0.02 from a to the rest
    EXPECT_EQ(chain.break_at({kinematics, 0.021, nullptr, &regions, region.data()}), 0);
    EXPECT_EQ(chain.break_at({kinematics, 0.019, nullptr, &regions, region.data()}), 1);
    EXPECT_EQ(chain.word, (std::vector<std::uint64_t>{0, 0, 1, 0, 0}));
    EXPECT_EQ(chain.break_at({kinematics, 0.0067, nullptr, &regions, region.data()}), 0);
    EXPECT_EQ(chain.break_at({kinematics, 0.0066, nullptr, &regions, region.data()}), 1);
  }
}

TEST(Breaker, SharesOfBothEndsScaleTheCriticalStretch)
{
  const std::vector<double> shares{0.0, 0.05, 0.15, -0.25, 0.0}; // 1.2 and 0.9 of it
  const std::vector<double> swelling{0.0, 0.001, 0.001, 0.001, 0.0};
  for (const auto kinematics : {Kinematics::finite, Kinematics::small})
    for (const bool swells : {false, true}) {
      Chain chain;
      chain.u[0] = {0.0, 0.0, 0.02, 0.04, 0.0}; // s = 0.01 of both, and of it 0.002 free
      const double own = swells ? 0.008 : 0.01;
      const auto break_at = [&](double factor) {
        pd::BreakRule rule{kinematics, own / factor};
        rule.shares = shares.data();
        rule.least_share = 0.75;
        pd::BondView<2> view = chain.view();
        view.swelling = swells ? swelling.data() : nullptr;
        return pd::break_bonds<2>(view, chain.runs, rule, {chain.word.data(), nullptr});
      };
      EXPECT_EQ(break_at(0.89), 0);
      EXPECT_EQ(break_at(0.91), 1);
      EXPECT_EQ(chain.word, (std::vector<std::uint64_t>{0, 1, 0, 0, 0}));
      EXPECT_EQ(break_at(1.19), 0);
      EXPECT_EQ(break_at(1.21), 1);
    }
}

TEST(Breaker, SqueezedBondsHold)
{
  Chain chain;
  chain.u[0] = {0.0, 0.0, -0.5, -1.0, 0.0};
  for (const auto kinematics : {Kinematics::finite, Kinematics::small})
    EXPECT_EQ(chain.break_at({kinematics, 1e-6}), 0);
}

TEST(Breaker, RotationStretchesOnlyTheLinearisedBond)
{
  Chain chain; // turned by 0.1 rad: |y| = |xi|, but xi.eta/|xi|^2 = cos 0.1 - 1 = -0.005
  for (int k = 0; k < 3; ++k) {
    chain.u[0][k + 1] = 2.0 * k * (std::cos(0.1) - 1.0);
    chain.u[1][k + 1] = 2.0 * k * std::sin(0.1);
  }
  EXPECT_EQ(chain.break_at({Kinematics::finite, 1e-12}), 0);
  for (int k = 0; k < 3; ++k) chain.u[0][k + 1] = 0.0; // a shear: sqrt(1 + sin^2 0.1) - 1 = 0.00497
  EXPECT_EQ(chain.break_at({Kinematics::small, 1e-12}), 0);
  EXPECT_EQ(chain.break_at({Kinematics::finite, 0.0050}), 0);
  EXPECT_EQ(chain.break_at({Kinematics::finite, 0.0049}), 2);
}

TEST(Breaker, SeesSmallStretchesExactly)
{
  Chain chain; // s = 1e-13: |xi + eta| - |xi| would have lost three digits of it
  chain.u[0] = {0.0, 0.0, 2e-13, 4e-13, 0.0};
  EXPECT_EQ(chain.break_at({Kinematics::finite, 1.0001e-13}), 0);
  EXPECT_EQ(chain.break_at({Kinematics::finite, 0.9999e-13}), 2);
}

TEST(Breaker, NoFailZonesHold)
{
  Chain chain;
  chain.u[0] = {0.0, 0.0, 0.2, 0.4, 0.0};
  const std::uint8_t zone[5] = {0, 1, 0, 0, 0}; // the first particle: its bond holds, the other breaks
  EXPECT_EQ(chain.break_at({Kinematics::finite, 0.01, zone}), 1);
  EXPECT_EQ(chain.word[1], 1u);
  EXPECT_EQ(chain.word[2], 0u);
}

template <int Dim> bool has_bond(const Window<Dim>& window, const typename Window<Dim>::Pair& pair)
{
  const std::ptrdiff_t i = window.particles[pair.i], jump = window.particles[pair.j] - i;
  for (std::size_t h = 0; h < window.arms.size(); ++h)
    if (window.arms[h].jump == jump) return (window.words[h / 64][i] >> h % 64 & 1u) != 0;
  return false;
}

/// Breaks bonds of a random window at a random displacement, and compares every bond with a loop over pairs.
template <int Dim> void expect_breaks_as_pairs(Window<Dim>& window, Kinematics kinematics, double s0)
{
  const std::vector<double> u = window.random_vector(0.2 * window.kDx, 11);
  const auto spread = window.spread(u);
  std::set<std::tuple<Index, Index>> left;
  std::int64_t broken = 0;
  for (const auto& pair : window.pairs) {
    const Vector<Dim> eta = at<Dim>(u, pair.j) - at<Dim>(u, pair.i);
    const double length = pair.xi.norm();
    const double s =
        kinematics == Kinematics::finite ? (pair.xi + eta).norm() / length - 1.0 : pair.xi.dot(eta) / (length * length);
    if (s > s0)
      ++broken;
    else
      left.emplace(pair.i, pair.j);
  }
  const std::span<const pd::Run> runs(window.runs);
  EXPECT_GT(broken, 100);
  EXPECT_GT(left.size(), 100u);
  EXPECT_EQ(pd::count_bonds(window.view(spread), runs), static_cast<std::int64_t>(window.pairs.size()));
  EXPECT_EQ(pd::break_bonds<Dim>(window.view(spread), runs, {kinematics, s0}, writable(window)), broken);
  EXPECT_EQ(pd::count_bonds(window.view(spread), runs), static_cast<std::int64_t>(left.size()));
  for (const auto& pair : window.pairs) ASSERT_EQ(has_bond(window, pair), left.count({pair.i, pair.j}) == 1);
}

TEST(Breaker, EqualsALoopOverPairs)
{
  for (const auto kinematics : {Kinematics::small, Kinematics::finite}) {
    Window<2> plate({30, 12}, {.ratio = 4.0, .missing = 0.1, .broken = 0.2});
    expect_breaks_as_pairs(plate, kinematics, 0.02);
    Window<2> wide({30, 14}, {6.5, law::Micromodulus::uniform, 0.05, 0.3, false}); // two words
    expect_breaks_as_pairs(wide, kinematics, 0.02);
    Window<3> solid({14, 8, 7}, {.ratio = 3.0, .missing = 0.1, .broken = 0.3});
    expect_breaks_as_pairs(solid, kinematics, 0.02);
  }
}

// Two ranks' views of one window: each owns half of the runs and breaks its own particles' bonds.
TEST(Breaker, PartsCountEachBondOnceAndAgreeOnTheirBorder)
{
  const Window<2> whole({30, 12}, {.ratio = 3.0, .missing = 0.1, .broken = 0.2});
  const std::vector<double> u = whole.random_vector(0.2 * whole.kDx, 12);
  const auto spread = whole.spread(u);
  Window<2> together = whole, lower = whole, upper = whole;
  const std::span<const pd::Run> runs(whole.runs);
  const std::size_t half = runs.size() / 2;
  const pd::BreakRule rule{Kinematics::finite, 0.02};
  const auto broken = pd::break_bonds<2>(together.view(spread), runs, rule, writable(together));
  const auto below = pd::break_bonds<2>(lower.view(spread), runs.first(half), rule, writable(lower));
  const auto above = pd::break_bonds<2>(upper.view(spread), runs.subspan(half), rule, writable(upper));
  EXPECT_EQ(below + above, broken);
  EXPECT_GT(std::min(below, above), 100);
  const Index border = runs[half].row;
  int across = 0;
  for (const auto& pair : whole.pairs) { // every rank sees the bonds that touch its particles as they are
    const bool intact = has_bond(together, pair);
    EXPECT_TRUE((pair.i >= border && pair.j >= border) || has_bond(lower, pair) == intact);
    EXPECT_TRUE((pair.i < border && pair.j < border) || has_bond(upper, pair) == intact);
    across += (pair.i < border) != (pair.j < border);
  }
  EXPECT_GT(across, 50);
}
} // namespace
