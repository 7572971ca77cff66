#include "support/followed_crack.hpp"

namespace pdx::test {
// Measured: along branches rms .05, at most .2 spacings beside.
TEST(FoundCrack, BranchesAreFollowedFromBehindTheForkToTheirTips)
{
  CrackedLattice plate({88, 72}, 3.0);
  const Vector<2> from(0.0, 35.3), fork = from + 20.0 * towards(4.0);
  const Vector<2> tips[] = {fork + 48.0 * towards(27.0), fork + 48.0 * towards(-19.0)};
  plate.cut({from, fork, tips[0]}).cut({fork, tips[1]});
  const auto cells = plate.cells(4, 4);
  for (const Vector<2>& tip : tips) {
    const Vector<2> direction = (tip - fork).normalized(), place = fork + 34.0 * direction;
    const auto seed = std::ranges::find_if(cells, [&](const geom::Box<2>& cell) { return cell.contains(place); });
    const auto found = track::follow_both_ways(plate.graph(), cells, static_cast<std::size_t>(seed - cells.begin()));
    ASSERT_TRUE(found);
    expect_chain(found->ahead, cells, found->ahead.crossings.front().in);
    EXPECT_LT((found->ahead.tip - tip).norm(), 0.9);
    EXPECT_LT((found->tip_behind - fork).norm(), 24.0);
    EXPECT_LT((found->ahead.crossings.front().in - fork).norm(), 24.0);
    EXPECT_GT(found->ahead.crossings.size(), 6u);
    Errors path;
    walk(found->ahead.crossings, [&](const Vector<2>& x, std::size_t) { path.add(beside(direction, x - fork)); });
    EXPECT_LT(path.rms(), 0.1);
    EXPECT_LT(path.most, 0.3);
  }
}

TEST(FoundCrack, IsTheSameFromAnyOfItsCells)
{
  CrackedLattice plate({72, 40}, 3.0);
  const Vector<2> from(12.2, 9.3), direction = towards(15.0);
  plate.cut({from, from + 48.0 * direction});
  const auto cells = plate.cells(4, 4);
  int tried = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto found = track::follow_both_ways(plate.graph(), cells, c);
    if (!found) continue;
    ++tried;
    EXPECT_LT((found->ahead.tip - (from + 48.0 * direction)).norm(), 0.9);
    EXPECT_LT((found->tip_behind - from).norm(), 0.9);
  }
  EXPECT_GT(tried, 6);
}

TEST(FoundCrack, NothingIsFoundWhereNothingIsParted)
{
  CrackedLattice plate({40, 40}, 3.0);
  plate.cut({{0.0, 20.3}, {14.0, 20.3}});
  const auto cells = plate.cells(4, 4);
  EXPECT_FALSE(track::follow_both_ways(plate.graph(), cells, 0));
  EXPECT_FALSE(track::follow_both_ways(plate.graph(), cells, 59));
}
} // namespace pdx::test
