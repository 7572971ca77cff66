#include "support/followed_crack.hpp"

#include <algorithm>

namespace pdx::test {
namespace {
track::Followed by_laplacian(const CrackedLattice& plate, const std::vector<geom::Box<2>>& cells, const Vector<2>& from,
                             const Vector<2>& direction)
{
  return track::follow(plate.graph(), cells, from, direction, track::Tracker::laplacian);
}
} // namespace

// Measured: rms .044-.050, at most .42; tips .1 to .17 ahead on average, rms .33, at most .8.
class FollowLaplacian : public testing::TestWithParam<std::tuple<double, Index>> {};

TEST_P(FollowLaplacian, StraightCracksAreFollowedToTenthsOfASpacing)
{
  const auto [ratio, r] = GetParam();
  std::mt19937 random(7);
  Errors path, tip;
  double mean = 0.0;
  for (int degrees = 10; degrees <= 40; degrees += 5)
    for (int k = 0; k < 4; ++k) {
      const Straight crack = straight_crack(degrees, ratio, random);
      const auto cells = crack.plate.cells(r, r);
      const track::Followed followed = by_laplacian(crack.plate, cells, crack.from, crack.direction);
      expect_chain(followed, cells, crack.from);
      ASSERT_FALSE(followed.crossings.empty());
      walk(followed.crossings,
           [&](const Vector<2>& x, std::size_t) { path.add(beside(crack.direction, x - crack.from)); });
      tip.add(crack.direction.dot(followed.tip - crack.tip));
      mean += crack.direction.dot(followed.tip - crack.tip) / 28.0;
      EXPECT_LT(std::abs(beside(crack.direction, followed.tip - crack.tip)), 1.0);
    }
  EXPECT_LT(path.rms(), 0.06);
  EXPECT_LT(path.most, 0.46);
  EXPECT_LT(std::abs(mean), 0.3);
  EXPECT_LT(tip.most, 1.0);
}

// Measured: rms .09-.12 (20 horizons) and .18-.25 (10 horizons), tips to .57.
TEST_P(FollowLaplacian, ArcsAreFollowedToTenthsOfASpacing)
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
      const track::Followed followed = by_laplacian(plate, cells, arc.points.front(), arc.direction);
      expect_chain(followed, cells, arc.points.front());
      walk(followed.crossings, [&](const Vector<2>& x, std::size_t) { path.add(arc.beside(x)); });
      tip.add((followed.tip - arc.points.back()).norm());
    }
    EXPECT_LT(path.rms(), radii > 15.0 ? 0.14 : 0.27);
    EXPECT_LT(tip.most, 0.8);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, FollowLaplacian, testing::Combine(testing::Values(3.0, 4.0), testing::Values(4, 5, 8)));

TEST(FollowLaplacian, NothingBrokenIsNothingFollowed)
{
  CrackedLattice plate({40, 40}, 3.0);
  const Vector<2> from(11.3, 20.2), direction = towards(20.0);
  const track::Followed followed = by_laplacian(plate, plate.cells(5, 5), from, direction);
  EXPECT_TRUE(followed.crossings.empty());
  EXPECT_EQ(followed.tip, from);
  EXPECT_EQ(followed.direction, direction);
}
} // namespace pdx::test
