#include "pdx/law/tip_field.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using law::TipLoad;

namespace {
const law::Elastic kPlate{3.0, 1.0 / 3.0, law::Plane::stress}, kThick{3.0, 0.25, law::Plane::strain};

Tensor<2> tip_stress(TipLoad load, const law::Elastic& elastic, double r, double angle)
{
  const Tensor<2> h = law::tip_gradient(load, elastic, r, angle);
  const Eigen::Vector3d s = elastic.stiffness() * Eigen::Vector3d(h(0, 0), h(1, 1), h(0, 1) + h(1, 0));
  return Tensor<2>{{s[0], s[2]}, {s[2], s[1]}};
}
} // namespace

TEST(TipField, GradientIsThatOfTheDisplacement)
{
  for (const law::Elastic& elastic : {kPlate, kThick})
    for (const TipLoad load : {TipLoad::opening, TipLoad::sliding, TipLoad::force})
      for (const double angle : {-2.9, -1.0, 0.3, 2.2}) {
        const double r = 0.7, h = 1e-5;
        const auto at = [&](double dx, double dy) {
          const double x = r * std::cos(angle) + dx, y = r * std::sin(angle) + dy;
          return law::tip_displacement(load, elastic, std::hypot(x, y), std::atan2(y, x));
        };
        Tensor<2> differences;
        differences.col(0) = (at(h, 0) - at(-h, 0)) / (2 * h);
        differences.col(1) = (at(0, h) - at(0, -h)) / (2 * h);
        EXPECT_LT((law::tip_gradient(load, elastic, r, angle) - differences).norm(), 1e-9);
      }
}

TEST(TipField, HasTheStressOfItsLoad)
{
  for (const law::Elastic& elastic : {kPlate, kThick}) {
    const double r = 0.4, near = 1.0 / std::sqrt(2.0 * std::numbers::pi * r);
    const Tensor<2> opening = tip_stress(TipLoad::opening, elastic, r, 0.0);
    EXPECT_NEAR(opening(0, 0), near, 1e-14); // ahead of the tip all of K / sqrt(2 pi r)
    EXPECT_NEAR(opening(1, 1), near, 1e-14);
    EXPECT_NEAR(opening(0, 1), 0.0, 1e-14);
    EXPECT_NEAR(tip_stress(TipLoad::sliding, elastic, r, 0.0)(0, 1), near, 1e-14);
    for (const double angle : {-2.0, 0.5, 1.5}) { // [Kfouri, 1986]: -cos / (pi r) along the ray, nothing else
      const Vector<2> ray(std::cos(angle), std::sin(angle));
      const Tensor<2> expected = -ray.x() / (std::numbers::pi * r) * ray * ray.transpose();
      EXPECT_LT((tip_stress(TipLoad::force, elastic, r, angle) - expected).norm(), 1e-14);
    }
  }
}

TEST(TipField, LeavesTheFacesOfTheCrackFree)
{
  for (const TipLoad load : {TipLoad::opening, TipLoad::sliding, TipLoad::force})
    for (const double face : {-std::numbers::pi, std::numbers::pi})
      EXPECT_LT(tip_stress(load, kThick, 0.4, face).col(1).norm(), 1e-14);
}
