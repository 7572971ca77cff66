#include "pdx/couple/contact_tangent.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

using namespace pdx;

namespace test_contact_tangent {
using couple::ContactSkin;

/// A point before a facet: k (d0 - d)^2 / 2 by distances alone, its second derivative by differences.
template <int Dim> struct Case {
  std::vector<Vector<Dim>> x; ///< the point, then the facet
  double d0 = 1.0, k = 7.0;

  typename ContactSkin<Dim>::Facet facet() const
  {
    typename ContactSkin<Dim>::Facet f;
    f.count = static_cast<int>(x.size()) - 1;
    for (int c = 0; c < f.count; ++c) f.points[static_cast<std::size_t>(c)] = 1 + c;
    return f;
  }
  double energy(const std::vector<Vector<Dim>>& at) const
  {
    const double overlap = d0 - couple::distance_to<Dim>(facet(), at, at[0]);
    return 0.5 * k * overlap * overlap;
  }
  /// @param weights of the place that is nearest
  void expect_differences(const std::array<double, Dim>& weights) const
  {
    couple::Touch<Dim> touch;
    Vector<Dim> from = x[0];
    for (std::size_t c = 0; c + 1 < x.size(); ++c) from -= weights[c] * x[c + 1];
    touch.weights = weights;
    touch.distance = from.norm();
    touch.normal = from / touch.distance;
    touch.overlap = d0 - touch.distance;
    ASSERT_NEAR(touch.distance, couple::distance_to<Dim>(facet(), x, x[0]), 1e-12); // they are of the nearest place
    const auto tangent = couple::contact_tangent<Dim>(touch, std::span(x).subspan(1), k);
    const double step = 1e-4;
    const auto moved = [&](Eigen::Index i, double by_i, Eigen::Index j, double by_j) {
      std::vector<Vector<Dim>> at = x;
      at[static_cast<std::size_t>(i / Dim)][i % Dim] += by_i;
      at[static_cast<std::size_t>(j / Dim)][j % Dim] += by_j;
      return energy(at);
    };
    const auto size = static_cast<Eigen::Index>(Dim * x.size());
    ASSERT_EQ(tangent.rows(), size);
    for (Eigen::Index i = 0; i < size; ++i)
      for (Eigen::Index j = 0; j < size; ++j) {
        const double second = (moved(i, step, j, step) - moved(i, step, j, -step) - moved(i, -step, j, step) +
                               moved(i, -step, j, -step)) /
                              (4.0 * step * step);
        EXPECT_NEAR(tangent(i, j), second, 2e-6 * k) << i << " " << j;
      }
  }
};

TEST(ContactTangent, IsTheSecondDerivativeBeforeASegment)
{
  const Vector<2> a(-1.0, 0.2), b(2.0, 0.5), along = b - a, normal = Vector<2>(-along[1], along[0]).normalized();
  Case<2>{{a + 0.3 * along + 0.6 * normal, a, b}}.expect_differences({0.7, 0.3});
  Case<2>{{a + 0.3 * along - 0.6 * normal, a, b}}.expect_differences({0.7, 0.3});
}

TEST(ContactTangent, IsTheSecondDerivativeBeforeACorner)
{
  Case<2>{{{2.3, 0.9}, {-1.0, 0.2}, {2.0, 0.5}}}.expect_differences({0.0, 1.0});
  Case<3>{{{0.3, 0.4, 0.5}, {0.1, 0.0, 0.2}}}.expect_differences({1.0, 0.0, 0.0});
}

TEST(ContactTangent, IsTheSecondDerivativeBeforeATriangleAndAnEdge)
{
  const Vector<3> a(0.0, 0.0, 0.1), b(2.0, 0.2, 0.0), c(0.3, 1.7, -0.2);
  const Vector<3> normal = (b - a).cross(c - a).normalized();
  Case<3>{{0.5 * a + 0.3 * b + 0.2 * c + 0.7 * normal, a, b, c}}.expect_differences({0.5, 0.3, 0.2});
  const Vector<3> away = ((a - b).cross(normal)).normalized(); // off the edge a b, from c
  const double side = away.dot(c - a) > 0.0 ? -1.0 : 1.0;
  Case<3>{{0.6 * a + 0.4 * b + 0.5 * (side * away + normal), a, b, c}}.expect_differences({0.6, 0.4, 0.0});
}
} // namespace test_contact_tangent
