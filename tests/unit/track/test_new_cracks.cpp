// Cracks that begin at the border of a body, from damage of particles beside them.
#include "pdx/track/new_cracks.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using track::Arrival;
using track::CrackStart;
using track::TreeGround;

namespace new_cracks_test {
constexpr double kApart = 0.1;
const geom::Box<2> kSheet{{0.0, 0.0}, {6.0, 3.0}};

TreeGround sheet()
{
  const geom::Lattice<2> lattice{{0.0, 0.0}, kApart, {60, 30}};
  return {geom::ActiveLattice<2>{lattice, geom::SiteSet<2>(lattice)}, 3.0 * kApart, {{0, 0}, 60, 0, 1}};
}

/// Two columns of particles on either side of a crack from the lower border, `rows` deep, one a load.
void grow_up(Index column, Index rows, std::vector<Arrival>& arrivals)
{
  for (Index j = 0; j < rows; ++j)
    for (const Index i : {column - 1, column}) arrivals.push_back({sheet().names.of({i, j}), 1.0 + j});
}
} // namespace new_cracks_test
using namespace new_cracks_test;

TEST(NewCracks, BeginAtTheBorderAndStayWhereTheyStop)
{
  std::vector<Arrival> arrivals;
  grow_up(10, 5, arrivals);
  grow_up(30, 20, arrivals);
  grow_up(45, 12, arrivals);
  const auto tips = track::new_cracks(arrivals, {sheet()}, kSheet, {});
  ASSERT_EQ(tips.size(), 3u);
  const double mouths[] = {1.0, 3.0, 4.5}, lengths[] = {0.45, 1.95, 1.15}; // to the middle of the last particle
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(tips[k].path.front().at[0], mouths[k], 1e-12);
    EXPECT_NEAR(tips[k].path.front().at[1], 0.0, 1e-12);
    EXPECT_NEAR(tips[k].at[0], mouths[k], 1e-12);
    EXPECT_NEAR(tips[k].length, lengths[k], 0.5 * kApart);
    EXPECT_EQ(tips[k].path.front().time, 1.0);
  }
  EXPECT_EQ(tips[0].path.back().time, 5.0);
  EXPECT_EQ(tips[1].path.back().time, 20.0);
}

TEST(NewCracks, AreNotWhatAGivenTipBecame)
{
  std::vector<Arrival> arrivals;
  grow_up(10, 5, arrivals);
  const CrackStart given{{4.0, 1.5}, {1.0, 0.0}};
  for (Index i = 40; i < 60; ++i) // through the border on the right
    for (const Index j : {14, 15}) arrivals.push_back({sheet().names.of({i, j}), 2.0 + i});
  const auto tips = track::new_cracks(arrivals, {sheet()}, kSheet, {&given, 1});
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_NEAR(tips[0].path.front().at[0], 1.0, 1e-12);
}

TEST(NewCracks, InsideHaveTwoEndsAndOnePath)
{
  std::vector<Arrival> arrivals;
  for (Index i = 20; i < 40; ++i)
    for (const Index j : {14, 15}) arrivals.push_back({sheet().names.of({i, j}), 1.0});
  const auto tips = track::new_cracks(arrivals, {sheet()}, kSheet, {});
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_NEAR(tips[0].length, 1.9, 2.0 * kApart);
}
