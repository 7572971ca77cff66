#include "pdx/mesh/locate.hpp"

#include <gtest/gtest.h>
#include <random>
#include <vector>

using pdx::Index;
using pdx::Vector;

namespace {
/// n x n cells of size 1, inner vertices moved at random by up to 0.2; natural numbers in a random order.
class DistortedGrid {
public:
  explicit DistortedGrid(int n) : n_(n)
  {
    std::uniform_real_distribution<double> move(-0.2, 0.2);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const bool rim = i == 0 || j == 0 || i == n || j == n;
        points_.emplace_back(i + (rim ? 0.0 : move(random_)), j + (rim ? 0.0 : move(random_)));
        natural_.push_back(static_cast<Index>(natural_.size()));
      }
    std::shuffle(natural_.begin(), natural_.end(), random_);
  }
  /// Cells that hold x.
  int holders(const Vector<2>& x, double tolerance) const
  {
    int count = 0;
    for (int j = 0; j < n_; ++j)
      for (int i = 0; i < n_; ++i) {
        std::array<Vector<2>, 4> corners;
        std::array<Index, 4> natural{};
        const std::size_t first = vertex(i, j), row = static_cast<std::size_t>(n_) + 1;
        const std::size_t vertices[4] = {first, first + 1, first + row + 1, first + row};
        // Start at a corner that differs from cell to cell: the answer must not depend on it.
        for (std::size_t k = 0; k < 4; ++k) {
          const std::size_t v = vertices[(k + first) % 4];
          corners[k] = points_[v];
          natural[k] = natural_[v];
        }
        count += pdx::mesh::cell_holds(corners, natural, x, tolerance);
      }
    return count;
  }
  std::size_t vertex(int i, int j) const { return static_cast<std::size_t>(j * (n_ + 1) + i); }
  const Vector<2>& point(int i, int j) const { return points_[vertex(i, j)]; }
  std::mt19937& random() { return random_; }

private:
  int n_;
  std::mt19937 random_{7};
  std::vector<Vector<2>> points_;
  std::vector<Index> natural_;
};

constexpr std::array<Index, 4> kNatural{0, 1, 3, 2};
const std::array<Vector<2>, 4> kSquare{Vector<2>(0, 0), Vector<2>(1, 0), Vector<2>(1, 1), Vector<2>(0, 1)};
} // namespace

TEST(MeshLocate, OneCellHoldsEveryRandomPoint)
{
  DistortedGrid grid(6);
  std::uniform_real_distribution<double> place(0.1, 5.9);
  for (int k = 0; k < 2000; ++k) {
    const Vector<2> x(place(grid.random()), place(grid.random()));
    ASSERT_EQ(grid.holders(x, 1e-9), 1) << x.transpose();
  }
}

TEST(MeshLocate, OneCellHoldsPointsOnEdgesAndVertices)
{
  DistortedGrid grid(6);
  std::uniform_real_distribution<double> along(0.0, 1.0);
  for (double tolerance : {0.0, 1e-12, 1e-9, 1e-3})
    for (int j = 1; j < 5; ++j)
      for (int i = 1; i < 5; ++i) {
        const Vector<2> a = grid.point(i, j), right = grid.point(i + 1, j), up = grid.point(i, j + 1);
        ASSERT_EQ(grid.holders(a, tolerance), 1) << i << " " << j << " tolerance " << tolerance;
        for (int k = 0; k < 20; ++k) {
          const double t = along(grid.random());
          ASSERT_EQ(grid.holders(a + t * (right - a), tolerance), 1) << "on a lower edge, tolerance " << tolerance;
          ASSERT_EQ(grid.holders(a + t * (up - a), tolerance), 1) << "on a left edge, tolerance " << tolerance;
        }
      }
}

TEST(MeshLocate, OneCellHoldsPointsWithinTheToleranceOfAVertex)
{
  DistortedGrid grid(4);
  std::uniform_real_distribution<double> near(-3e-6, 3e-6);
  for (int j = 1; j < 4; ++j)
    for (int i = 1; i < 4; ++i)
      for (int k = 0; k < 500; ++k) {
        const Vector<2> x = grid.point(i, j) + Vector<2>(near(grid.random()), near(grid.random()));
        ASSERT_EQ(grid.holders(x, 1e-6), 1);
      }
}

TEST(MeshLocate, PointThatIsShiftedOntoAVertexHasOneCell)
{
  DistortedGrid grid(4);
  const double tolerance = 1e-6;
  for (int j = 1; j < 4; ++j)
    for (int i = 1; i < 4; ++i)
      for (int steps = -3; steps <= 3; ++steps) { // a few units in the last place around the worst point
        Vector<2> x = grid.point(i, j) - tolerance * Vector<2>(1.618, 1.0);
        x[0] += steps * 4.4e-16;
        ASSERT_EQ(grid.holders(x, tolerance), 1);
      }
}

TEST(MeshLocate, EdgePointsGoToTheUpperRightInSpiteOfRounding)
{
  const double tolerance = 1e-9;
  for (double noise : {-1e-12, 0.0, 1e-12}) {
    EXPECT_TRUE(pdx::mesh::cell_holds(kSquare, kNatural, {noise, 0.5}, tolerance));
    EXPECT_FALSE(pdx::mesh::cell_holds(kSquare, kNatural, {1.0 + noise, 0.5}, tolerance));
    EXPECT_TRUE(pdx::mesh::cell_holds(kSquare, kNatural, {0.5, noise}, tolerance));
    EXPECT_FALSE(pdx::mesh::cell_holds(kSquare, kNatural, {0.5, 1.0 + noise}, tolerance));
  }
  EXPECT_FALSE(pdx::mesh::cell_holds(kSquare, kNatural, {-1e-6, 0.5}, tolerance));
  EXPECT_TRUE(pdx::mesh::cell_holds(kSquare, kNatural, {1.0 - 1e-6, 0.5}, tolerance));
}

TEST(MeshLocate, WeightsOfASquareAreTheProductForm)
{
  const auto w = pdx::mesh::bilinear_weights(kSquare, {0.25, 0.5});
  EXPECT_NEAR(w[0], 0.75 * 0.5, 1e-15);
  EXPECT_NEAR(w[1], 0.25 * 0.5, 1e-15);
  EXPECT_NEAR(w[2], 0.25 * 0.5, 1e-15);
  EXPECT_NEAR(w[3], 0.75 * 0.5, 1e-15);
}

TEST(MeshLocate, WeightsReproduceThePointInsideAndJustOutside)
{
  const std::array<Vector<2>, 4> corners{Vector<2>(0, 0), Vector<2>(2, 0.3), Vector<2>(1.6, 1.5), Vector<2>(-0.2, 1)};
  for (double s = -0.2; s < 1.25; s += 0.1)
    for (double t = -0.2; t < 1.25; t += 0.1) {
      const double expected[4] = {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
      Vector<2> x = Vector<2>::Zero();
      for (std::size_t k = 0; k < 4; ++k) x += expected[k] * corners[k];
      const auto w = pdx::mesh::bilinear_weights(corners, x);
      EXPECT_NEAR(w[0] + w[1] + w[2] + w[3], 1.0, 1e-14);
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(w[k], expected[k], 1e-12) << s << " " << t;
    }
}

TEST(MeshLocate, WeightsOfAParallelogramMayExtrapolateFar)
{
  const std::array<Vector<2>, 4> corners{Vector<2>(1, 1), Vector<2>(3, 2), Vector<2>(4, 4), Vector<2>(2, 3)};
  // x = corner 0 + 3 (2, 1) - 2 (1, 2): s = 3, t = -2
  const auto w = pdx::mesh::bilinear_weights(corners, {5, 0});
  EXPECT_NEAR(w[0], (1 - 3.0) * (1 + 2.0), 1e-12);
  EXPECT_NEAR(w[1], 3.0 * (1 + 2.0), 1e-12);
  EXPECT_NEAR(w[2], 3.0 * -2.0, 1e-12);
  EXPECT_NEAR(w[3], (1 - 3.0) * -2.0, 1e-12);
}
