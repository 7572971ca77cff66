#include "pdx/fem/shape.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
const fem::Corners kCell{{{0.1, 0.0}, {2.0, 0.3}, {1.7, 1.9}, {-0.2, 1.1}}};
}

TEST(Shape, FunctionsSumToOneAndGradientsToZero)
{
  const Vector<2> xi(0.3, -0.7);
  EXPECT_NEAR(fem::shape(xi).sum(), 1.0, 1e-15);
  EXPECT_NEAR(fem::map_point(kCell, xi).gradients.rowwise().sum().norm(), 0.0, 1e-15);
}

TEST(Shape, EachFunctionIsOneAtItsCornerAndZeroAtTheOthers)
{
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) EXPECT_EQ(fem::shape(fem::reference_corners().col(a))[b], a == b ? 1.0 : 0.0);
}

TEST(Shape, CornersRunCounterClockwise)
{
  const fem::Gradients c = fem::reference_corners();
  for (int a = 0; a < 4; ++a) {
    const Vector<2> p = c.col(a), q = c.col((a + 1) % 4);
    EXPECT_EQ(p.x() * q.y() - p.y() * q.x(), 2.0);
  }
}

TEST(Shape, GradientsInSpaceReproduceALinearField)
{
  const Vector<2> slope(3.0, -2.0);
  Eigen::Vector4d values;
  for (std::size_t a = 0; a < 4; ++a) values[static_cast<Index>(a)] = 5.0 + slope.dot(kCell[a]);
  const Vector<2> found = fem::map_point(kCell, {-0.4, 0.6}).gradients * values;
  EXPECT_NEAR((found - slope).norm(), 0.0, 1e-14);
}

TEST(Shape, GaussPointsIntegrateTheAreaOfADistortedCell)
{
  double area = 0.0, shoelace = 0.0;
  for (int g = 0; g < 4; ++g) area += fem::map_point(kCell, fem::gauss_points().col(g)).jacobian;
  for (std::size_t a = 0; a < 4; ++a) {
    const Vector<2>&p = kCell[a], &q = kCell[(a + 1) % 4];
    shoelace += 0.5 * (p.x() * q.y() - p.y() * q.x());
  }
  EXPECT_NEAR(area, shoelace, 1e-15);
}
