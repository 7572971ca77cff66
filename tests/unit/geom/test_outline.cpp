#include "pdx/geom/outline.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace pdx::geom::outline_test {
namespace {
std::vector<Outline::Edge> closed(const std::vector<Vector<2>>& corners)
{
  std::vector<Outline::Edge> edges;
  for (std::size_t k = 0; k < corners.size(); ++k) edges.push_back({corners[k], corners[(k + 1) % corners.size()]});
  return edges;
}

TEST(Outline, OfNothingHoldsNothing) { EXPECT_FALSE(Outline().holds({0.0, 0.0})); }

TEST(Outline, BoxesThatMeetShareTheirBorderOut)
{
  const Outline left(Outline::edges_of({{0.0, 0.0}, {1.0, 1.0}})), right(Outline::edges_of({{1.0, 0.0}, {2.0, 1.0}}));
  const Outline above(Outline::edges_of({{0.0, 1.0}, {2.0, 2.0}}));
  for (const Vector<2>& x : {Vector<2>(1.0, 0.5), Vector<2>(1.0, 1.0), Vector<2>(0.5, 1.0), Vector<2>(0.3, 0.7)})
    EXPECT_EQ(left.holds(x) + right.holds(x) + above.holds(x), 1) << x.transpose();
  EXPECT_FALSE(left.holds({-1e-9, 0.5}));
  EXPECT_FALSE(left.holds({0.5, 1.0 + 1e-9}));
}

TEST(Outline, RingLeavesItsHoleOut)
{
  std::vector<Outline::Edge> edges = Outline::edges_of({{0.0, 0.0}, {3.0, 3.0}});
  for (const Outline::Edge& edge : Outline::edges_of({{1.0, 1.0}, {2.0, 2.0}})) edges.push_back(edge);
  const Outline ring(edges);
  EXPECT_TRUE(ring.holds({0.5, 1.5}));
  EXPECT_FALSE(ring.holds({1.5, 1.5}));
  EXPECT_TRUE(ring.holds({2.5, 2.9}));
}

TEST(Outline, DiscOfManyEdgesIsOfItsRadius)
{
  std::vector<Vector<2>> corners;
  constexpr int count = 1000;
  for (int k = 0; k < count; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / count;
    corners.emplace_back(std::cos(angle), std::sin(angle));
  }
  const Outline disc(closed(corners));
  int inside = 0;
  constexpr int side = 400;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const Vector<2> x((i + 0.5) * 2.0 / side - 1.0, (j + 0.5) * 2.0 / side - 1.0);
      if (std::abs(x.norm() - 1.0) > 1e-4) {
        EXPECT_EQ(disc.holds(x), x.norm() < 1.0) << x.transpose();
      }
      inside += disc.holds(x);
    }
  EXPECT_NEAR(4.0 * inside / (side * side), std::numbers::pi, 2e-3);
}
} // namespace
} // namespace pdx::geom::outline_test
