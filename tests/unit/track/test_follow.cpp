#include "pdx/track/follow.hpp"
#include "support/followed_crack.hpp"

#include <algorithm>

using namespace pdx;
using namespace pdx::test;
using track::Crossing;
using track::Followed;

namespace {
using Sites = CrackedLattice::Bond;
/// The plate with its sites moved by a map of the plate onto itself or its transpose.
CrackedLattice moved(const CrackedLattice& plate, const Site<2>& count, const std::function<Site<2>(Site<2>)>& map)
{
  CrackedLattice other(count, plate.horizon() / plate.lattice.dx);
  for (const auto& [a, b] : plate.gone) {
    const Site<2> p = map(a), q = map(b);
    const bool up = q[1] > p[1] || (q[1] == p[1] && q[0] > p[0]);
    other.gone.insert(up ? Sites{p, q} : Sites{q, p});
  }
  return other;
}

std::vector<geom::Box<2>> moved(const std::vector<geom::Box<2>>& cells,
                                const std::function<Vector<2>(const Vector<2>&)>& map)
{
  std::vector<geom::Box<2>> others;
  for (const geom::Box<2>& cell : cells) {
    const Vector<2> a = map(cell.lower), b = map(cell.upper);
    others.push_back({a.cwiseMin(b), a.cwiseMax(b)});
  }
  return others;
}

void expect_moved(const Followed& here, const Followed& there, const std::function<Vector<2>(const Vector<2>&)>& map,
                  double dx)
{
  ASSERT_EQ(here.crossings.size(), there.crossings.size());
  for (std::size_t c = 0; c < here.crossings.size(); ++c) {
    EXPECT_EQ(here.crossings[c].cell, there.crossings[c].cell);
    EXPECT_LT((map(here.crossings[c].in) - there.crossings[c].in).norm(), 1e-8 * dx);
    EXPECT_LT((map(here.crossings[c].out) - there.crossings[c].out).norm(), 1e-8 * dx);
  }
  EXPECT_LT((map(here.tip) - there.tip).norm(), 1e-8 * dx);
  const Vector<2> direction = (map(here.direction) - map(Vector<2>::Zero())).normalized();
  EXPECT_LT((direction - there.direction).norm(), 1e-8);
}
} // namespace

class FollowCells : public testing::TestWithParam<std::tuple<double, Index>> {};

// Measured over these: rms .03-.05, at most .15 (.21 in the first cells, whose windows the side of the plate clips);
// tips -.14 to .2.
TEST_P(FollowCells, StraightCracksAreFollowedToSomeHundredthsOfASpacing)
{
  const auto [ratio, r] = GetParam();
  std::mt19937 random(7);
  Errors path, first, tip;
  double lag = 0.0;
  for (int degrees = 10; degrees <= 40; degrees += 5)
    for (int k = 0; k < 4; ++k) {
      const Straight crack = straight_crack(degrees, ratio, random);
      const auto cells = crack.plate.cells(r, r);
      const Followed followed = follow(crack.plate.graph(), cells, crack.from, crack.direction);
      expect_chain(followed, cells, crack.from);
      ASSERT_FALSE(followed.crossings.empty());
      walk(followed.crossings, [&](const Vector<2>& x, std::size_t c) {
        (c < 2 ? first : path).add(beside(crack.direction, x - crack.from));
      });
      tip.add(crack.direction.dot(followed.tip - crack.tip));
      EXPECT_LT(std::abs(beside(crack.direction, followed.tip - crack.tip)), 0.6);
      EXPECT_GT(crack.direction.dot(followed.direction), 0.95);
      lag = std::max(lag, crack.direction.dot(crack.tip - followed.crossings.back().out));
    }
  EXPECT_LT(path.rms(), 0.055);
  EXPECT_LT(path.most, 0.21);
  EXPECT_LT(first.most, 0.25);
  EXPECT_LT(tip.rms(), 0.12);
  EXPECT_LT(tip.most, 0.3);
  EXPECT_LT(lag, 1.5 * r + ratio + 1.0); // the last cell's window ends before the tip
}

// Measured: rms .08-.10 (20 horizons) and .14-.20 (10 horizons), tips to .23.
TEST_P(FollowCells, ArcsAreFollowedToTenthsOfASpacing)
{
  const auto [ratio, r] = GetParam();
  std::mt19937 random(11);
  for (const double radii : {20.0, 10.0}) {
    Errors path, tip;
    for (int k = 0; k < 6; ++k) {
      const Arc arc(radii * ratio, k % 2 ? 1.0 : -1.0, random);
      CrackedLattice plate({64, 64}, ratio);
      plate.cut(arc.points);
      const auto cells = plate.cells(r, r);
      const Vector<2>&from = arc.points.front(), &end = arc.points.back();
      const Followed followed = follow(plate.graph(), cells, from, arc.direction);
      expect_chain(followed, cells, from);
      walk(followed.crossings, [&](const Vector<2>& x, std::size_t) { path.add(arc.beside(x)); });
      tip.add(arc.onwards.dot(followed.tip - end));
      EXPECT_LT((followed.tip - end).norm(), 0.9);
      ASSERT_FALSE(followed.crossings.empty());
      EXPECT_LT((followed.crossings.back().out - end).norm(), 1.5 * r + ratio + 2.0);
    }
    EXPECT_LT(path.rms(), radii > 15.0 ? 0.12 : 0.23);
    EXPECT_LT(path.most, 0.5);
    EXPECT_LT(tip.most, 0.3);
  }
}

// What is broken beside the path turns no cell into one that is not parted.
TEST_P(FollowCells, BrokenBondsBesideThePathLeadNowhere)
{
  const auto [ratio, r] = GetParam();
  std::mt19937 random(13);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  Errors path, tip;
  std::size_t whole = 0, damaged = 0;
  for (const double degrees : {12.0, 20.0, 33.0}) {
    Straight crack = straight_crack(degrees, ratio, random);
    const auto cells = crack.plate.cells(r, r);
    whole += follow(crack.plate.graph(), cells, crack.from, crack.direction).crossings.size();
    crack.plate.for_each_bond([&](const CrackedLattice::Bond& bond) {
      const Vector<2> x = crack.plate.lattice.point(bond.first) - crack.from;
      const bool near = std::abs(beside(crack.direction, x)) < ratio && crack.direction.dot(x) < 38.0;
      if (near && share(random) < 0.15) crack.plate.gone.insert(bond);
    });
    const Followed followed = follow(crack.plate.graph(), cells, crack.from, crack.direction);
    damaged += followed.crossings.size();
    expect_chain(followed, cells, crack.from);
    walk(followed.crossings,
         [&](const Vector<2>& x, std::size_t) { path.add(beside(crack.direction, x - crack.from)); });
    tip.add(crack.direction.dot(followed.tip - crack.tip));
  }
  EXPECT_EQ(whole, damaged);
  EXPECT_LT(path.rms(), 0.06);
  EXPECT_LT(tip.most, 0.45);
}

TEST_P(FollowCells, CrackAlongALineOfTheMeshIsExactlyOnItAndInTheCellsOnItsRight)
{
  const auto [ratio, r] = GetParam();
  const Index n = 8 * r;
  for (int quarter = 0; quarter < 4; ++quarter) {
    CrackedLattice plate({n, n}, ratio);
    const Vector<2> direction = towards(90.0 * quarter).array().round();
    const Vector<2> from = Vector<2>::Constant(4 * r) - 4 * r * direction, tip = from + (6.0 * r + 0.3) * direction;
    plate.cut({from, tip});
    const auto cells = plate.cells(r, r);
    for (const double off : {0.0, 4e-4 * r, -4e-4 * r}) { // rounding decides nothing
      const Vector<2> aside(-off * direction[1], off * direction[0]);
      const Followed followed = follow(plate.graph(), cells, from + aside, direction);
      expect_chain(followed, cells, from);
      ASSERT_GE(followed.crossings.size(), 4u);
      for (const Crossing& crossing : followed.crossings) {
        EXPECT_EQ(beside(direction, crossing.out - from), 0.0);
        EXPECT_NEAR((crossing.out - crossing.in).norm(), r, 1e-12);
        const Vector<2> middle = 0.5 * (cells[crossing.cell].lower + cells[crossing.cell].upper);
        EXPECT_LT(beside(direction, middle - from), 0.0);
      }
      EXPECT_NEAR(direction.dot(followed.tip - tip), 0.0, 0.5);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, FollowCells, testing::Combine(testing::Values(3.0, 4.0), testing::Values(4, 5, 8)));

// Every second particle of a diagonal lies on it and counts as left: the crack is seen half a row aside.
TEST(Follow, DiagonalAndAxes)
{
  for (const double degrees : {0.0, 45.0, 90.0, 180.0, 225.0, -90.0, -45.0})
    for (const double ratio : {3.0, 4.0}) {
      const Vector<2> direction = towards(degrees), tip(20.23, 20.71), from = tip - 17.3 * direction;
      CrackedLattice plate({40, 40}, ratio);
      plate.cut({tip - 40.0 * direction, tip});
      const auto cells = plate.cells(5, 5);
      const Followed followed = follow(plate.graph(), cells, from, direction);
      expect_chain(followed, cells, from);
      ASSERT_GE(followed.crossings.size(), 2u) << degrees;
      walk(followed.crossings,
           [&](const Vector<2>& x, std::size_t) { EXPECT_LT(std::abs(beside(direction, x - from)), 0.5) << degrees; });
      EXPECT_LT(std::abs(direction.dot(followed.tip - tip)), 0.6) << degrees;
    }
}

TEST(Follow, PathThroughCornersIsOnThem)
{
  CrackedLattice plate({64, 32}, 3.0);
  const Vector<2> direction = Vector<2>(2.0, 1.0).normalized();
  plate.cut({{0.0, 0.0}, Vector<2>(48.0, 24.0)});
  const auto cells = plate.cells(8, 4);
  const Followed followed = follow(plate.graph(), cells, {0.0, 0.0}, direction);
  ASSERT_GE(followed.crossings.size(), 4u);
  for (std::size_t c = 1; c < followed.crossings.size(); ++c) {
    EXPECT_EQ(followed.crossings[c].in, Vector<2>(8.0 * static_cast<double>(c), 4.0 * static_cast<double>(c)));
    EXPECT_EQ(cells[followed.crossings[c].cell].lower, followed.crossings[c].in);
  }
}

TEST(Follow, NothingBrokenIsNothingFollowed)
{
  CrackedLattice plate({40, 40}, 3.0);
  const Vector<2> from(11.3, 20.2), direction = towards(20.0);
  for (int k = 0; k < 2; ++k) {
    const Followed followed = follow(plate.graph(), plate.cells(5, 5), from, direction);
    EXPECT_TRUE(followed.crossings.empty());
    EXPECT_EQ(followed.tip, from);
    EXPECT_EQ(followed.direction, direction);
    plate.cut({from - 11.0 * direction, from}); // what is known of the crack
  }
}

TEST(Follow, LoneIntactBondsHoldCellsTogetherButNotTheTip)
{
  std::mt19937 random(3);
  Straight crack = straight_crack(20.0, 3.0, random);
  const auto cells = crack.plate.cells(5, 5);
  const Followed whole = follow(crack.plate.graph(), cells, crack.from, crack.direction);
  const Vector<2> at = crack.from + 22.0 * crack.direction;
  for (int healed = 0; healed < 3; ++healed)
    crack.plate.gone.erase(*std::ranges::min_element(crack.plate.gone, {}, [&](const CrackedLattice::Bond& bond) {
      return (crack.plate.lattice.point(bond.first) - at).norm();
    }));
  const Followed held = follow(crack.plate.graph(), cells, crack.from, crack.direction);
  ASSERT_FALSE(held.crossings.empty());
  EXPECT_LT(held.crossings.size(), whole.crossings.size());
  for (std::size_t c = 0; c < held.crossings.size(); ++c) {
    EXPECT_EQ(held.crossings[c].cell, whole.crossings[c].cell);
    EXPECT_EQ(held.crossings[c].out, whole.crossings[c].out);
  }
  EXPECT_LT((held.crossings.back().out - at).norm(), 13.0);
  EXPECT_GT(crack.direction.dot(at - held.crossings.back().out), 0.0);
  EXPECT_LT((held.tip - whole.tip).norm(), 0.7);
  EXPECT_LT(std::abs(crack.direction.dot(held.tip - crack.tip)), 0.6);
}

TEST(Follow, BranchesEndTheCrossings)
{
  CrackedLattice plate({72, 64}, 3.0);
  const Vector<2> from(0.0, 31.3), fork = from + 24.0 * towards(4.0);
  plate.cut({from, fork, fork + 30.0 * towards(24.0)}).cut({fork, fork + 30.0 * towards(-16.0)});
  const auto cells = plate.cells(5, 5);
  const Followed followed = follow(plate.graph(), cells, from, towards(4.0));
  expect_chain(followed, cells, from);
  ASSERT_GE(followed.crossings.size(), 3u);
  EXPECT_LT(followed.crossings.back().out.x(), fork.x());
  EXPECT_GT(followed.crossings.back().out.x(), fork.x() - 10.0);
}

TEST(Follow, CrackAcrossTheBodyEndsAtItsEdge)
{
  CrackedLattice plate({40, 40}, 3.0);
  const Vector<2> from(0.0, 10.3), direction = towards(15.0);
  plate.cut({from, from + 40.0 / direction.x() * direction});
  const auto cells = plate.cells(5, 5);
  const Followed followed = follow(plate.graph(), cells, from, direction);
  expect_chain(followed, cells, from);
  ASSERT_FALSE(followed.crossings.empty());
  EXPECT_EQ(followed.crossings.back().out.x(), 40.0);
  EXPECT_EQ(followed.tip, followed.crossings.back().out);
}

TEST(Follow, CellsMayBeOfDifferentSizesAndInAnyOrder)
{
  std::mt19937 random(5);
  Straight crack = straight_crack(25.0, 3.0, random);
  std::vector<geom::Box<2>> cells;
  for (const geom::Box<2>& block : crack.plate.cells(8, 8)) {
    const Vector<2> middle = 0.5 * (block.lower + block.upper);
    if (random() % 2) {
      cells.push_back(block);
      continue;
    }
    for (const Vector<2>& corner : {block.lower, block.upper, Vector<2>(block.lower[0], block.upper[1]),
                                    Vector<2>(block.upper[0], block.lower[1])})
      cells.push_back({corner.cwiseMin(middle), corner.cwiseMax(middle)});
  }
  const Followed followed = follow(crack.plate.graph(), cells, crack.from, crack.direction);
  expect_chain(followed, cells, crack.from);
  EXPECT_LT(crack.direction.dot(crack.tip - followed.crossings.back().out), 15.0);
  walk(followed.crossings,
       [&](const Vector<2>& x, std::size_t) { EXPECT_LT(std::abs(beside(crack.direction, x - crack.from)), 0.3); });
  std::vector<geom::Box<2>> others = cells;
  std::ranges::shuffle(others, random);
  const Followed again = follow(crack.plate.graph(), others, crack.from, crack.direction);
  ASSERT_EQ(again.crossings.size(), followed.crossings.size());
  for (std::size_t c = 0; c < again.crossings.size(); ++c) {
    EXPECT_EQ(others[again.crossings[c].cell].lower, cells[followed.crossings[c].cell].lower);
    EXPECT_EQ(again.crossings[c].out, followed.crossings[c].out);
  }
  EXPECT_EQ(again.tip, followed.tip);
}

// Only cells that are there: what was handed back before is not followed again.
TEST(Follow, GoesOnFromWhereItEnded)
{
  std::mt19937 random(17);
  for (const double degrees : {11.0, 28.0, 37.0}) {
    const Straight crack = straight_crack(degrees, 3.0, random);
    const auto cells = crack.plate.cells(5, 5);
    const Followed whole = follow(crack.plate.graph(), cells, crack.from, crack.direction);
    const std::size_t half = whole.crossings.size() / 2;
    std::vector<geom::Box<2>> left;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto before = [&](std::size_t k) { return whole.crossings[k].cell == c; };
      bool there = true;
      for (std::size_t k = 0; k < half; ++k) there = there && !before(k);
      if (there) left.push_back(cells[c]);
    }
    const Crossing& last = whole.crossings[half - 1];
    const Followed rest = follow(crack.plate.graph(), left, last.out, crack.direction);
    ASSERT_EQ(rest.crossings.size(), whole.crossings.size() - half);
    for (std::size_t k = 0; k < rest.crossings.size(); ++k)
      EXPECT_LT((rest.crossings[k].out - whole.crossings[half + k].out).norm(), 0.01);
    EXPECT_LT((rest.tip - whole.tip).norm(), 0.01);
  }
}

TEST(Follow, CrackMayTurnWhereItIsKnownToEnd)
{
  CrackedLattice plate({64, 64}, 3.0);
  const Vector<2> known(20.4, 30.3), direction = towards(50.0), tip = known + 30.0 * direction;
  plate.cut({{0.0, 30.3}, known, tip});
  const auto cells = plate.cells(5, 5);
  const Followed followed = follow(plate.graph(), cells, known, {1.0, 0.0});
  expect_chain(followed, cells, known);
  ASSERT_GE(followed.crossings.size(), 4u);
  walk(followed.crossings,
       [&](const Vector<2>& x, std::size_t) { EXPECT_LT(std::abs(beside(direction, x - known)), 0.4); });
  EXPECT_LT(std::abs(direction.dot(followed.tip - tip)), 0.6);
}

TEST(Follow, MirroredTurnedAndScaledCracksArePathsMirroredTurnedAndScaled)
{
  std::mt19937 random(23);
  for (const double degrees : {0.0, 17.0, 31.0, 45.0}) {
    Straight crack = straight_crack(degrees, 3.0, random);
    const auto [w, h] = crack.plate.lattice.count;
    const auto cells = crack.plate.cells(8, 4);
    const Followed here = follow(crack.plate.graph(), cells, crack.from, crack.direction);
    ASSERT_GE(here.crossings.size(), 3u);

    const auto mirror = [h = h](const Vector<2>& x) { return Vector<2>(x[0], h - x[1]); };
    const CrackedLattice mirrored = moved(crack.plate, {w, h}, [h = h](Site<2> s) {
      return Site<2>{s[0], h - 1 - s[1]};
    });
    expect_moved(
        here,
        follow(mirrored.graph(), moved(cells, mirror), mirror(crack.from), {crack.direction[0], -crack.direction[1]}),
        mirror, 1.0);

    const auto turn = [h = h](const Vector<2>& x) { return Vector<2>(h - x[1], x[0]); };
    const CrackedLattice turned = moved(crack.plate, {h, w}, [h = h](Site<2> s) {
      return Site<2>{h - 1 - s[1], s[0]};
    });
    expect_moved(
        here, follow(turned.graph(), moved(cells, turn), turn(crack.from), {-crack.direction[1], crack.direction[0]}),
        turn, 1.0);

    const Vector<2> origin(-0.013, 0.42);
    const double dx = 1.7e-4;
    CrackedLattice scaled({w, h}, 3.0, dx, origin);
    scaled.gone = crack.plate.gone;
    const auto scale = [&](const Vector<2>& x) { return Vector<2>(origin + dx * x); };
    expect_moved(here, follow(scaled.graph(), moved(cells, scale), scale(crack.from), crack.direction), scale, dx);
  }
}
