#include "pdx/track/crack_tree.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>

using namespace pdx;
using track::Arrival;
using track::CrackTree;
using track::GrownTip;

namespace {
// Sites at half numbers; horizon 3, so that branches and speeds need 6.
const geom::Lattice<2> kLattice{{0.0, -20.0}, 1.0, {80, 40}};
const track::TreeGround kGround{kLattice, 3.0, {{}, 80}}; // the name of a site is its number
constexpr double kSpeed = 4.0;

/// Damage that runs along straight lines, a band of half-width 1 around each.
class Runner {
public:
  explicit Runner(std::vector<track::CrackStart> starts) : tree(std::move(starts), {kGround}) {}

  /// Arrivals around the way from a to b, at times by the way done, and by look of one unit of time.
  Runner& along(const Vector<2>& a, const Vector<2>& b, double begin, double speed = kSpeed)
  {
    const Vector<2> way = (b - a).normalized();
    const double length = (b - a).norm();
    for (Index site = 0; site < static_cast<Index>(kLattice.total()); ++site) {
      const Vector<2> from = kLattice.point(kLattice.site(site)) - a;
      const double on = way.dot(from), beside = std::abs(way.x() * from.y() - way.y() * from.x());
      if (on < 0.0 || on > length || beside > 1.0 || !seen_.insert(site).second) continue;
      waiting_.push_back({static_cast<std::uint64_t>(site), begin + on / speed});
    }
    return *this;
  }
  Runner& arrive()
  {
    std::ranges::sort(waiting_, {}, &Arrival::time);
    for (double look = 1.0; !waiting_.empty(); look += 1.0) {
      const auto later = std::ranges::find_if(waiting_, [&](const Arrival& a) { return a.time > look; });
      tree.add({waiting_.begin(), later});
      waiting_.erase(waiting_.begin(), later);
    }
    return *this;
  }
  CrackTree tree;

private:
  std::vector<Arrival> waiting_;
  std::set<Index> seen_;
};

double slope(const Vector<2>& v) { return std::atan2(v.y(), v.x()); }
} // namespace

TEST(CrackTree, CrackThatStaysHasItsTipWhereItWas)
{
  const CrackTree tree({{{10.0, 0.0}, {1.0, 0.0}}}, {kGround});
  const auto tips = tree.tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_EQ(tips[0].at, Vector<2>(10.0, 0.0));
  EXPECT_EQ(tips[0].length, 0.0);
  EXPECT_FALSE(tree.start_time());
}

TEST(CrackTree, StraightCrackBetweenTwoRows)
{
  Runner run({{{10.0, 0.0}, {1.0, 0.0}}});
  run.along({10.0, 0.0}, {40.0, 0.0}, 2.0).arrive();
  const auto tips = run.tree.tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_NEAR(tips[0].at.x(), 39.5, 1e-12);
  EXPECT_NEAR(tips[0].at.y(), 0.0, 1e-12);
  EXPECT_NEAR(tips[0].length, 29.5, 0.1); // within the start's circle: as the crow flies
  EXPECT_NEAR(*run.tree.start_time(), 2.0 + 0.5 / kSpeed, 1e-12);
  EXPECT_NEAR(track::tip_speed(tips[0], 6.0, 10.0, 1.0), kSpeed, 1e-12);
}

TEST(CrackTree, SlantedCrackHasItsAngleLengthAndSpeed)
{
  const Vector<2> way(std::cos(1.1), std::sin(1.1));
  Runner run({{{10.0, -15.0}, {1.0, 0.0}}});
  run.along({10.0, -15.0}, Vector<2>(10.0, -15.0) + 30.0 * way, 0.0).arrive();
  const auto tips = run.tree.tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_NEAR(slope(tips[0].at - Vector<2>(10.0, -15.0)), 1.1, 0.04);
  EXPECT_NEAR(tips[0].length, 30.0, 1.2); // chains of lattice steps are up to 3 % longer
  EXPECT_NEAR(track::tip_speed(tips[0], 6.0, 7.5, 1.0), kSpeed, 0.02 * kSpeed);
}

TEST(CrackTree, BranchesAreTwoTipsThatPartWhereTheyDid)
{
  const Vector<2> fork(30.0, 0.0), up(50.0, 12.0), down(47.5, -10.5);
  Runner run({{{10.0, 0.0}, {1.0, 0.0}}});
  run.along({10.0, 0.0}, fork, 0.0).along(fork, up, 20.0 / kSpeed).along(fork, down, 20.0 / kSpeed).arrive();
  const auto tips = run.tree.tips();
  ASSERT_EQ(tips.size(), 2u);
  EXPECT_NEAR((tips[0].at - up).norm(), 0.0, 1.5);
  EXPECT_NEAR((tips[1].at - down).norm(), 0.0, 1.5);
  EXPECT_FALSE(tips[0].branched);
  ASSERT_TRUE(tips[1].branched);
  EXPECT_NEAR((tips[1].branched->at - fork).norm(), 0.0, 4.0);
  EXPECT_NEAR(tips[1].branched->time, 5.0, 1.0);
  EXPECT_NEAR(tips[1].own, 20.4, 4.0);
  EXPECT_NEAR(tips[1].length, 20.0 + 20.4, 1.5);
}

TEST(CrackTree, ShortSideBranchIsNone)
{
  Runner run({{{10.0, 0.0}, {1.0, 0.0}}});
  run.along({10.0, 0.0}, {50.0, 0.0}, 0.0).along({30.0, 1.0}, {30.0, 5.0}, 5.0).arrive();
  EXPECT_EQ(run.tree.tips().size(), 1u);
}

TEST(CrackTree, BothTipsOfACentralCrackGrowTheirOwn)
{
  Runner run({{{35.0, 0.0}, {-1.0, 0.0}}, {{45.0, 0.0}, {1.0, 0.0}}});
  run.along({35.0, 0.0}, {15.0, 0.0}, 1.0).along({45.0, 0.0}, {57.0, 0.0}, 1.0).arrive();
  const auto tips = run.tree.tips();
  ASSERT_EQ(tips.size(), 2u);
  EXPECT_NEAR(tips[0].at.x(), 15.5, 1e-12);
  EXPECT_NEAR(tips[1].at.x(), 56.5, 1e-12);
  EXPECT_EQ(tips[1].start, 1u);
}

TEST(CrackTree, DamageElsewhereCountsOnceItHangsTogetherWithTheCrack)
{
  Runner run({{{10.0, 0.0}, {1.0, 0.0}}});
  run.along({10.0, 0.0}, {20.0, 0.0}, 0.0).along({30.0, 0.0}, {40.0, 0.0}, 0.0).arrive();
  EXPECT_NEAR(run.tree.tips()[0].at.x(), 19.5, 1e-12);
  run.along({20.0, 0.0}, {30.0, 0.0}, 3.0).arrive();
  EXPECT_NEAR(run.tree.tips()[0].at.x(), 39.5, 1e-12);
}

TEST(CrackTree, TipThatWaitsSlowsDown)
{
  Runner run({{{10.0, 0.0}, {1.0, 0.0}}});
  run.along({10.0, 0.0}, {40.0, 0.0}, 0.0).arrive();
  const GrownTip tip = run.tree.tips()[0];
  const double arrived = 29.5 / kSpeed;
  EXPECT_NEAR(track::tip_speed(tip, 6.0, arrived + 1.0, 1.0), kSpeed, 1e-12);
  EXPECT_NEAR(track::tip_speed(tip, 6.0, arrived + 11.0, 1.0), 0.6, 1e-12);
  EXPECT_EQ(track::tip_speed(tip, 50.0, arrived, 1.0), 0.0);
}

namespace {
/// A way to look at the same scene: turned, mirrored, larger or elsewhere.
struct View {
  bool swapped = false, mirrored = false;
  double dx = 1.0;
  Vector<2> corner = Vector<2>::Zero();
};

/// A fork in a lattice of 80 x 40, whose arms are as long in steps but not in time: rows, arms and looks tie.
class Fork {
public:
  explicit Fork(const View& view) : view_(view)
  {
    const Site<2> count = view.swapped ? Site<2>{40, 80} : Site<2>{80, 40};
    const geom::Lattice<2> lattice{view.corner, view.dx, count};
    const Vector<2> along = seen({1.0, 0.0});
    CrackTree tree({{view.corner + view.dx * place({10.0, 20.0}), along}}, {{lattice, 3.0 * view.dx, {{}, count[0]}}});
    std::vector<Arrival> all;
    for (Index i = 10; i < 70; ++i)
      for (const Index j : {19, 20}) add(lattice, all, i, i < 40 ? j : j + (j == 19 ? 39 - i : i - 39) / 2, j);
    std::ranges::sort(all, {}, &Arrival::time);
    for (double look = 1.5; !all.empty(); look += 1.5) {
      const auto later = std::ranges::find_if(all, [&](const Arrival& a) { return a.time > look; });
      tree.add({all.begin(), later});
      all.erase(all.begin(), later);
    }
    tips = tree.tips();
    for (const GrownTip& tip : tips) speed = std::max(speed, track::tip_speed(tip, tree.span(0), 20.0, 1.5) / view.dx);
  }

  std::vector<GrownTip> tips;
  double speed = 0.0; // in spacings

private:
  Vector<2> seen(Vector<2> way) const
  {
    if (view_.mirrored) way.y() = -way.y();
    if (view_.swapped) std::swap(way.x(), way.y());
    return way;
  }
  Vector<2> place(Vector<2> at) const
  {
    if (view_.mirrored) at.y() = 40.0 - at.y();
    if (view_.swapped) std::swap(at.x(), at.y());
    return at;
  }
  void add(const geom::Lattice<2>& lattice, std::vector<Arrival>& all, Index i, Index j, Index row) const
  {
    const Vector<2> at = place({i + 0.5, j + 0.5});
    const Site<2> site{static_cast<Index>(at.x()), static_cast<Index>(at.y())};
    // The lower row is later, and unevenly so.
    const double time = 0.25 * (i - 9) + (row == 19 ? 0.01 * (i % 7) : 0.0) + 1e-14 * ((i * 7 + j) % 5);
    all.push_back({static_cast<std::uint64_t>(lattice.number(site)), time});
  }
  View view_;
};
} // namespace

TEST(CrackTree, SpeedAndBranchDoNotDependOnHowTheSceneIsTurnedScaledOrPlaced)
{
  const Fork plain({});
  ASSERT_EQ(plain.tips.size(), 2u);
  ASSERT_TRUE(plain.tips[1].branched);
  EXPECT_GT(plain.speed, 3.0);
  const double third = 1.0 / 3.0;
  for (const View& view : {View{false, true, 1.0, {0.0, 0.0}}, View{true, false, 1.0, {0.0, 0.0}},
                           View{true, true, 1.0, {0.0, 0.0}}, View{false, false, third, {0.1, -0.7}},
                           View{false, true, third, {1e3 * third, 7e2}}, View{true, true, 1e-3, {third, 1e-3}}}) {
    const Fork other(view);
    ASSERT_EQ(other.tips.size(), 2u);
    EXPECT_NEAR(other.speed, plain.speed, 1e-9);
    for (std::size_t t = 0; t < 2; ++t) {
      EXPECT_NEAR(other.tips[t].length / view.dx, plain.tips[t].length, 1e-9);
      EXPECT_NEAR(other.tips[t].path.back().time, plain.tips[t].path.back().time, 1e-9);
      ASSERT_EQ(other.tips[t].branched.has_value(), plain.tips[t].branched.has_value());
    }
    EXPECT_NEAR(other.tips[1].branched->time, plain.tips[1].branched->time, 1e-9);
  }
}

TEST(CrackTree, RowsThatAreAsFarShareTheTipsTime)
{
  CrackTree tree({{{10.0, 0.0}, {1.0, 0.0}}}, {kGround});
  std::vector<Arrival> all;
  for (Index i = 10; i < 40; ++i)
    for (const Index j : {19, 20}) all.push_back({kGround.names.of({i, j}), 1.0 * i + (j == 19 ? 0.5 : 0.0)});
  tree.add(all);
  const auto tips = tree.tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_NEAR(tips[0].path.back().time, 39.25, 1e-12);
  EXPECT_NEAR(tips[0].at.y(), 0.0, 1e-12);
}

TEST(CrackTree, GoesOnWhereParticlesCameLater)
{
  // They lay up to x = 20 first; sites beyond have names all the same.
  const geom::Lattice<2> first{{0.0, -20.0}, 1.0, {20, 40}};
  CrackTree small({{{10.0, 0.0}, {1.0, 0.0}}}, {{first, 3.0, kGround.names}});
  Runner large({{{10.0, 0.0}, {1.0, 0.0}}});
  large.along({10.0, 0.0}, {40.0, 0.0}, 2.0).arrive();
  small.add({large.tree.arrivals().begin(), large.tree.arrivals().end()});
  EXPECT_EQ(small.tips()[0].length, large.tree.tips()[0].length);
  EXPECT_EQ(small.span(0), 12.0);
}

TEST(CrackTree, SitesAreKnownByTheirLatticeWhateverPieceOfItNamesThem)
{
  const geom::SiteNames names{{0, 0}, 200, 0, 3}, other{{5, 7}, 200, 1, 3}, piece{{20, 7}, 200, 0, 3};
  CrackTree tree({{{20.0, 0.0}, {1.0, 0.0}}}, {{kLattice, 3.0, names}, {kLattice, 3.0, other}});
  std::vector<Arrival> all;
  for (Index i = 0; i < 30; ++i) all.push_back({piece.of({i, 13}), 1.0 * i});
  const std::uint64_t beside = other.of({50, 20}); // as near, on another lattice
  all.push_back({beside, 30.0});
  tree.add(all);
  EXPECT_EQ(tree.tips()[0].at, kLattice.point({49, 20}));
  EXPECT_TRUE(tree.has(beside));
  EXPECT_EQ(*tree.place(all[0].site), kLattice.point({20, 20}));
  EXPECT_FALSE(tree.place(2)) << "of a third lattice";
}
