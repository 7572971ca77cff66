#include "pdx/geom/line_pieces.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

using namespace pdx;
using Set = geom::SiteSet<2>;

namespace {
struct Shape {
  const char* name;
  std::vector<Set::Corners> boxes;
};
const Shape kShapes[] = {{"box", {{{2, -3}, {7, 4}}}},
                         {"L", {{{0, 0}, {10, 4}}, {{0, 4}, {3, 9}}}},
                         {"ring", {{{0, 0}, {9, 2}}, {{0, 7}, {9, 9}}, {{0, 2}, {2, 7}}, {{6, 2}, {9, 7}}}},
                         {"staircase", {{{0, 0}, {4, 4}}, {{2, 2}, {8, 6}}, {{6, 5}, {12, 9}}}},
                         {"two halves", {{{1, 1}, {5, 6}}, {{5, 1}, {9, 6}}}},
                         {"corner", {{{-4, -4}, {0, 0}}, {{0, 0}, {5, 3}}}},
                         {"apart", {{{0, 0}, {3, 3}}, {{6, 1}, {8, 7}}}}};

bool in_a_box(const Shape& shape, const Site<2>& s)
{
  return std::ranges::any_of(shape.boxes, [&](const auto& box) {
    return s[0] >= box.first[0] && s[0] < box.second[0] && s[1] >= box.first[1] && s[1] < box.second[1];
  });
}

/// Every site of a region wider than all shapes, x fastest.
template <class Visit> void for_each(Visit&& visit)
{
  for (Site<2> s{0, -12}; s[1] < 16; ++s[1])
    for (s[0] = -12; s[0] < 20; ++s[0]) visit(std::as_const(s));
}
} // namespace

TEST(SiteSet, HasWhatLiesInABoxAndNumbersItInOrder)
{
  for (const Shape& shape : kShapes) {
    const Set set{std::span(shape.boxes)};
    std::int64_t place = 0;
    for_each([&](const Site<2>& s) {
      EXPECT_EQ(set.has(s), in_a_box(shape, s)) << shape.name << " " << s[0] << " " << s[1];
      if (!in_a_box(shape, s)) return;
      EXPECT_EQ(set.place(s), place) << shape.name;
      EXPECT_EQ(set.site(place), s) << shape.name;
      ++place;
    });
    EXPECT_EQ(set.size(), place) << shape.name;
    std::int64_t in_runs = 0;
    for (const auto& run : set.runs()) {
      EXPECT_EQ(run.place, in_runs) << shape.name;
      EXPECT_EQ(set.end_of_run(run.first), run.first[0] + run.length) << shape.name;
      in_runs += run.length;
    }
    EXPECT_EQ(in_runs, place) << shape.name;
  }
}

TEST(SiteSet, TwoHalvesAreTheBoxTheyMakeUp)
{
  EXPECT_TRUE(Set{std::span(kShapes[4].boxes)}.is_box());
  EXPECT_FALSE(Set{std::span(kShapes[1].boxes)}.is_box());
  EXPECT_EQ(Set().size(), 0);
}

TEST(SiteSet, ErodedAndGrownLookAtAllNeighbours)
{
  for (const Shape& shape : kShapes)
    for (const Index width : {1, 2, 3}) {
      const Set set{std::span(shape.boxes)}, eroded = set.eroded(width), grown = set.grown(width);
      for_each([&](const Site<2>& s) {
        bool all = true, any = false;
        for (Index j = -width; j <= width; ++j)
          for (Index i = -width; i <= width; ++i) {
            const bool there = in_a_box(shape, {s[0] + i, s[1] + j});
            all = all && there;
            any = any || there;
          }
        EXPECT_EQ(eroded.has(s), all) << shape.name << " " << width << ": " << s[0] << " " << s[1];
        EXPECT_EQ(grown.has(s), any) << shape.name << " " << width << ": " << s[0] << " " << s[1];
      });
    }
}

TEST(SiteSet, HasAllOfABoxOrNot)
{
  const Set set{std::span(kShapes[1].boxes)};
  EXPECT_TRUE(set.has_all({{0, 0}, {3, 9}}));
  EXPECT_TRUE(set.has_all({{1, 1}, {10, 4}}));
  EXPECT_FALSE(set.has_all({{0, 0}, {4, 9}}));
  EXPECT_FALSE(set.has_all({{-1, 0}, {3, 3}}));
}

// Each border of an active cell to one that is not lies on exactly one side, which is maximal.
TEST(SiteSet, StraightSidesAreTheWholeBorder)
{
  for (const Shape& shape : kShapes) {
    const Set set{std::span(shape.boxes)};
    std::set<std::array<Index, 4>> borders, found;
    for_each([&](const Site<2>& s) {
      for (const Index axis : {0, 1})
        for (const Index upper : {0, 1}) {
          Site<2> beyond = s;
          beyond[static_cast<std::size_t>(axis)] += upper ? 1 : -1;
          if (in_a_box(shape, s) && !in_a_box(shape, beyond))
            borders.insert(
                {axis, upper, s[static_cast<std::size_t>(axis)] + upper, s[static_cast<std::size_t>(1 - axis)]});
        }
    });
    std::set<std::array<Index, 4>> ends;
    for (const geom::StraightSide& side : geom::straight_sides(set)) {
      const auto axis = static_cast<Index>(side.axis), upper = static_cast<Index>(side.upper);
      for (Index k = side.from; k < side.to; ++k) EXPECT_TRUE(found.insert({axis, upper, side.at, k}).second);
      EXPECT_TRUE(ends.insert({axis, upper, side.at, side.from}).second);
      EXPECT_FALSE(borders.contains({axis, upper, side.at, side.from - 1})) << shape.name;
      EXPECT_FALSE(borders.contains({axis, upper, side.at, side.to})) << shape.name;
    }
    EXPECT_EQ(found, borders) << shape.name;
  }
}

TEST(SiteSet, CoversPointsOfItsCells)
{
  const geom::Lattice<2> lattice{{1.0, 2.0}, 0.25, {10, 9}};
  const geom::ActiveLattice<2> where(lattice, Set{std::span(kShapes[1].boxes)});
  const auto at = [&](double x, double y) { return Vector<2>(1.0 + 0.25 * x, 2.0 + 0.25 * y); };
  EXPECT_TRUE(geom::covers(where, at(0.0, 0.0), 0.0));
  EXPECT_TRUE(geom::covers(where, at(3.0, 4.0), 0.0)); // the re-entrant corner
  EXPECT_TRUE(geom::covers(where, at(3.0, 8.0), 0.0)); // on a side
  EXPECT_FALSE(geom::covers(where, at(3.1, 8.0), 0.02));
  EXPECT_TRUE(geom::covers(where, at(3.1, 8.0), 0.03));
  EXPECT_FALSE(geom::covers(where, at(6.0, 6.0), 0.0));
}

TEST(LinePieces, FollowEachOtherFromMiddleToMiddle)
{
  for (Index x = -7; x <= 7; ++x)
    for (Index y = -7; y <= 7; ++y) {
      const auto pieces = geom::pieces_of_line<2>({x, y});
      EXPECT_EQ(pieces.front().enter, 0.0);
      EXPECT_EQ(pieces.back().leave, 1.0);
      EXPECT_EQ(pieces.back().cell, (Site<2>{x, y}));
      for (std::size_t k = 0; k < pieces.size(); ++k) {
        const auto& [cell, enter, leave] = pieces[k];
        EXPECT_EQ(enter, k ? pieces[k - 1].leave : 0.0);
        EXPECT_LT(enter, leave);
        const double middle = 0.5 * (enter + leave);
        EXPECT_EQ(std::floor(0.5 + middle * x), cell[0]) << x << " " << y;
        EXPECT_EQ(std::floor(0.5 + middle * y), cell[1]) << x << " " << y;
      }
    }
}

// To the last bit what cutting the line by the box gives.
TEST(LinePieces, InABoxTheyAreOneClip)
{
  const Set set(Set::Corners{{0, 0}, {4, 3}});
  for (Index i = -5; i < 9; ++i)
    for (Index j = -5; j < 8; ++j)
      for (Index x = -6; x <= 6; ++x)
        for (Index y = -6; y <= 6; ++y) {
          const auto line = geom::pieces_of_line<2>({x, y});
          const auto parts = geom::parts_inside<2>(set, {i, j}, line);
          const Vector<2> from(i + 0.5, j + 0.5), to(i + x + 0.5, j + y + 0.5);
          const auto clip = geom::clip<2>(from, to, {{0.0, 0.0}, {4.0, 3.0}});
          ASSERT_LE(parts.size(), 1u);
          ASSERT_EQ(parts.size() == 1, clip && (clip->enter < clip->leave));
          if (parts.empty()) continue;
          EXPECT_EQ(parts[0].clip.enter, clip->enter);
          EXPECT_EQ(parts[0].clip.leave, clip->leave);
          EXPECT_EQ(geom::runs_inside<2>(set, {i, j}, line), clip->enter == 0.0 && clip->leave == 1.0);
        }
}

TEST(LinePieces, ALineThroughACornerOfCellsStaysInBoth)
{
  const Set pinch{std::span(kShapes[5].boxes)};
  const auto diagonal = geom::pieces_of_line<2>({1, 1}), other = geom::pieces_of_line<2>({1, -1});
  EXPECT_EQ(diagonal.size(), 2u);
  EXPECT_TRUE(geom::runs_inside<2>(pinch, {-1, -1}, diagonal));
  EXPECT_FALSE(geom::runs_inside<2>(pinch, {-1, 0}, other));
}

TEST(LinePieces, ALineOverANotchHasTwoParts)
{
  const Set notched(
      std::span<const Set::Corners>(std::vector<Set::Corners>{{{0, 0}, {9, 2}}, {{0, 2}, {3, 5}}, {{5, 2}, {9, 5}}}));
  const auto line = geom::pieces_of_line<2>({4, 0});
  const auto parts = geom::parts_inside<2>(notched, {2, 3}, line);
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].clip.enter, 0.0);
  EXPECT_EQ(parts[0].clip.leave, 0.125);
  EXPECT_EQ(parts[1].clip.enter, 0.625);
  EXPECT_EQ(parts[1].first, 3);
  EXPECT_TRUE(geom::runs_inside<2>(notched, {2, 1}, line));
}
