#include "pdx/adapt/seed_box.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numbers>

using namespace pdx;
using adapt::Corners;

namespace {
/// Elements between lines of a plate.
struct Lines {
  std::vector<double> x, y; // [m]

  std::vector<Corners> elements() const
  {
    std::vector<Corners> all;
    for (std::size_t j = 0; j + 1 < y.size(); ++j)
      for (std::size_t i = 0; i + 1 < x.size(); ++i)
        all.push_back({Vector<2>(x[i], y[j]), Vector<2>(x[i + 1], y[j]), Vector<2>(x[i + 1], y[j + 1]),
                       Vector<2>(x[i], y[j + 1])});
    return all;
  }
};

std::vector<double> even(int cells, double from, double size)
{
  std::vector<double> all;
  for (int k = 0; k <= cells; ++k) all.push_back(from + size * k);
  return all;
}

Lines plate() { return {even(10, 0.0, 1.0), even(10, 0.0, 1.0)}; }

std::vector<Corners> at(const std::vector<Corners>& all, const Vector<2>& tip)
{
  std::vector<Corners> own;
  std::ranges::copy_if(all, std::back_inserter(own),
                       [&](const Corners& element) { return adapt::share_of_turn(element, tip, 1e-6) > 0.0; });
  return own;
}

std::optional<geom::Box<2>> seed(const std::vector<Corners>& all, const Vector<2>& tip, double reach,
                                 double spacing = 0.25)
{
  return adapt::seed_box(at(all, tip), all, tip, spacing, reach);
}

/// As x0, y0, x1, y1.
std::array<double, 4> numbers(const std::optional<geom::Box<2>>& box)
{
  if (!box) return {};
  return {box->lower[0], box->lower[1], box->upper[0], box->upper[1]};
}

using Box = std::array<double, 4>;

Corners mirrored(const Corners& c, double width)
{
  const auto over = [width](const Vector<2>& x) { return Vector<2>(width - x[0], x[1]); };
  return {over(c[1]), over(c[0]), over(c[3]), over(c[2])};
}
} // namespace

TEST(SeedBox, HoldsElementsWithANodeInReach)
{
  const auto all = plate().elements();
  EXPECT_EQ(numbers(seed(all, {4.5, 5.5}, 0.1)), (Box{4, 5, 5, 6})); // no node is: the element of the tip alone
  EXPECT_EQ(numbers(seed(all, {4.5, 5.5}, 0.8)), (Box{3, 4, 6, 7}));
  EXPECT_EQ(numbers(seed(all, {4.5, 5.5}, 1.6)), (Box{2, 3, 7, 8}));
}

TEST(SeedBox, IsTheBoxAroundAllOfThem)
{
  const auto all = plate().elements();
  for (const Vector<2>& tip : {Vector<2>(4.5, 5.5), Vector<2>(4.2, 4.9), Vector<2>(5, 5), Vector<2>(5, 4.3)})
    for (const double reach : {0.31, 1.1, 1.9, 2.6, 3.31}) {
      geom::Box<2> expected = adapt::box_around(at(all, tip)[0]);
      for (const Corners& element : all) {
        const bool wanted = std::ranges::any_of(element, [&](const Vector<2>& x) { return (x - tip).norm() < reach; });
        if (!wanted && adapt::share_of_turn(element, tip, 1e-6) == 0.0) continue;
        const geom::Box<2> box = adapt::box_around(element);
        expected = {expected.lower.cwiseMin(box.lower), expected.upper.cwiseMax(box.upper)};
      }
      EXPECT_EQ(numbers(seed(all, tip, reach)), numbers(expected)) << tip.transpose() << " " << reach;
    }
}

TEST(SeedBox, GrowsEvenlyFromATipOnANodeAndOnAnEdge)
{
  const auto all = plate().elements();
  EXPECT_EQ(numbers(seed(all, {5, 5}, 0.1)), (Box{4, 4, 6, 6}));
  EXPECT_EQ(numbers(seed(all, {5, 5}, 1.0)), (Box{4, 4, 6, 6})); // nodes as far are not nearer
  EXPECT_EQ(numbers(seed(all, {5, 5}, 1.0 + 1e-7)), (Box{3, 3, 7, 7}));
  EXPECT_EQ(numbers(seed(all, {5, 5.5}, 0.1)), (Box{4, 5, 6, 6}));
  EXPECT_EQ(numbers(seed(all, {5, 5.5}, 0.6)), (Box{4, 4, 6, 7}));
}

TEST(SeedBox, RoundingOfTheTipDoesNotDecide)
{
  const auto all = plate().elements();
  for (const double off : {-1e-13, 0.0, 1e-13})
    EXPECT_EQ(numbers(seed(all, {5 + off, 5 - off}, 2.0)), (Box{3, 3, 7, 7}));
}

TEST(SeedBox, EndsWithTheBody)
{
  const auto all = plate().elements();
  EXPECT_EQ(numbers(seed(all, {0.5, 9.5}, 2.4)), (Box{0, 7, 3, 10}));
  EXPECT_EQ(numbers(seed(all, {0.5, 9.5}, 100.0)), (Box{0, 0, 10, 10}));
}

TEST(SeedBox, EndsBeforeElementsThatTheLatticeDoesNotDivide)
{
  Lines uneven = plate();
  for (std::size_t k = 7; k < uneven.x.size(); ++k) uneven.x[k] += 0.1;
  EXPECT_EQ(numbers(seed(uneven.elements(), {4.5, 5.5}, 3.2)), (Box{1, 2, 6, 9}));
  auto skew = plate().elements(); // one element ahead is no box: so much of its column stays
  for (Corners& element : skew)
    for (Vector<2>& x : element)
      if ((x - Vector<2>(7, 6)).norm() < 0.1) x[0] += 0.1;
  EXPECT_EQ(numbers(seed(skew, {4.5, 5.5}, 3.2)), (Box{1, 2, 6, 9}));
}

TEST(SeedBox, MirroredElementsHaveTheMirroredBox)
{
  Lines lines{even(12, 0.0, 0.1), even(9, 0.0, 0.1)};
  std::vector<Corners> all = lines.elements(), other;
  for (Corners& element : all)
    for (Vector<2>& x : element)
      if ((x - Vector<2>(0.9, 0.7)).norm() < 0.01 || (x - Vector<2>(0.3, 0.2)).norm() < 0.01)
        x += Vector<2>(0.01, 0.02);
  for (const Corners& element : all) other.push_back(mirrored(element, 1.2));
  for (const Vector<2>& tip : {Vector<2>(0.63, 0.44), Vector<2>(0.6, 0.5), Vector<2>(0.6, 0.42), Vector<2>(0.71, 0.5)})
    for (const double reach : {0.05, 0.1, 0.2, 0.3, 0.5}) {
      const Box box = numbers(seed(all, tip, reach, 0.025));
      const Box over = numbers(seed(other, {1.2 - tip[0], tip[1]}, reach, 0.025));
      EXPECT_NEAR(box[0], 1.2 - over[2], 1e-12);
      EXPECT_NEAR(box[2], 1.2 - over[0], 1e-12);
      EXPECT_NEAR(box[1], over[1], 1e-12);
      EXPECT_NEAR(box[3], over[3], 1e-12);
      EXPECT_GT(box[2], box[0]);
    }
}

TEST(SeedBox, IsNothingWhereTheElementsAtTheTipAreNotDivided)
{
  const auto all = plate().elements();
  EXPECT_FALSE(seed(all, {4.5, 5.5}, 1.0, 0.4));
  Lines uneven = plate();
  uneven.x[5] += 0.1;
  EXPECT_FALSE(seed(uneven.elements(), {5.1, 5.5}, 1.0, 0.25));
  EXPECT_TRUE(seed(uneven.elements(), {5.1, 5.5}, 1.0, 0.1));
  EXPECT_FALSE(adapt::seed_box({}, all, {4.5, 5.5}, 0.25, 1.0));
}

TEST(ShareOfTurn, AddsUpToOneInTheBodyOnly)
{
  const auto all = plate().elements();
  const auto sum = [&](const Vector<2>& x) {
    double turn = 0.0;
    for (const Corners& element : all) turn += adapt::share_of_turn(element, x, 1e-6);
    return turn;
  };
  for (const Vector<2>& x : {Vector<2>(4.5, 5.5), Vector<2>(5, 5.5), Vector<2>(5, 5), Vector<2>(5 + 1e-9, 5 - 1e-9)})
    EXPECT_NEAR(sum(x), 1.0, 1e-12);
  EXPECT_NEAR(sum({0, 5.5}), 0.5, 1e-12);
  EXPECT_NEAR(sum({0, 5}), 0.5, 1e-12);
  EXPECT_NEAR(sum({0, 0}), 0.25, 1e-12);
  EXPECT_EQ(sum({-0.1, 5}), 0.0);
}

TEST(ShareOfTurn, OfACornerIsItsAngle)
{
  const Corners skew{Vector<2>(0, 0), Vector<2>(2, 0), Vector<2>(2, 2), Vector<2>(0.5, 0.5 * std::numbers::sqrt3)};
  EXPECT_NEAR(adapt::share_of_turn(skew, {0, 0}, 1e-6), 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(adapt::share_of_turn(skew, {2, 0}, 1e-6), 0.25, 1e-12);
}
