#include "pdx/mpm/body.hpp"

#include "pdx/base/error.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace test_body {
using namespace pdx;

mpm::BodyMaterial material(double spacing, int ratio)
{
  mpm::BodyMaterial m;
  m.spacing = spacing;
  m.ratio = ratio;
  return m;
}

template <int Dim> mpm::Body<Dim> ball(double radius, double spacing)
{
  const geom::Box<Dim> reach{Vector<Dim>::Constant(-radius), Vector<Dim>::Constant(radius)};
  return mpm::fill_body<Dim>("ball", material(spacing, 2), reach,
                             [radius](const Vector<Dim>& x) { return x.squaredNorm() <= radius * radius; });
}

TEST(MpmBody, FillsABoxToItsSides)
{
  const geom::Box<2> box{{1.0, 2.0}, {1.5, 2.3}};
  const auto body =
      mpm::fill_body<2>("bar", material(0.1, 2), box, [&](const Vector<2>& x) { return box.contains(x, 0.0); });
  EXPECT_EQ(body.count(), 15);
  EXPECT_EQ(body.cells, (Site<2>{3, 2})); // 5 x 3 points in cells of 2 x 2
  EXPECT_EQ(body.points_in({0, 0}), 0b1111U);
  EXPECT_EQ(body.points_in({2, 1}), 0b0001U);
  EXPECT_EQ(body.points_in({3, 0}), 0U);
  EXPECT_NEAR((body.around().lower - box.lower).norm(), 0.0, 1e-14);
  EXPECT_NEAR((body.around().upper - box.upper).norm(), 0.0, 1e-14);
  EXPECT_NEAR((body.centre() - Vector<2>(1.25, 2.15)).norm(), 0.0, 1e-14);
}

TEST(MpmBody, KnowsItsSites)
{
  const auto body = ball<2>(1.0, 0.25);
  for (Index j = -1; j < 9; ++j)
    for (Index i = -1; i < 9; ++i) {
      const Vector<2> x(-1.0 + (i + 0.5) * 0.25, -1.0 + (j + 0.5) * 0.25);
      EXPECT_EQ(body.has({i, j}), x.norm() <= 1.0) << i << ", " << j;
    }
}

TEST(MpmBody, HasTheAreaOfADiscInTheEnd)
{
  const auto error = [](double spacing) {
    return std::abs(static_cast<double>(ball<2>(1.0, spacing).count()) * spacing * spacing / std::numbers::pi - 1.0);
  };
  EXPECT_LT(error(0.05), 2e-2);
  EXPECT_LT(error(0.005), 1e-3);
}

TEST(MpmBody, OfASphereMirrors)
{
  const auto body = ball<3>(1.0, 0.1);
  EXPECT_NEAR(static_cast<double>(body.count()) * 0.001 / (4.0 / 3.0 * std::numbers::pi), 1.0, 0.05);
  EXPECT_LT(body.centre().norm(), 1e-13);
}

TEST(MpmBody, RefusesWhatHoldsNoPoint)
{
  const geom::Box<2> box{{0.0, 0.0}, {1.0, 1.0}};
  EXPECT_THROW(mpm::fill_body<2>("none", material(0.5, 2), box, [](const Vector<2>&) { return false; }), UserError);
  EXPECT_THROW(mpm::fill_body<2>("vast", material(1e-6, 2), box, [](const Vector<2>&) { return true; }), UserError);
}
} // namespace test_body
