#include "pdx/scene/point_shapes.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace test_point_shapes {
using namespace pdx;

mpm::BodyMaterial lattice(double spacing)
{
  mpm::BodyMaterial m;
  m.spacing = spacing;
  m.ratio = 2;
  return m;
}

/// Calls visit(site, where its skin is) for the points at the surface of a body.
template <int Dim> int for_each_skin(const options::PointBodyOptions& body, const auto& visit)
{
  const auto of = scene::body_of<Dim>(body, lattice(body.spacing), {});
  int count = 0;
  for (std::size_t k = 0; k < of.points.size(); ++k) {
    const Site<Dim> cell = of.cell(static_cast<std::int64_t>(k));
    mpm::for_each_point(of.points[k], [&](int site) {
      if (!of.uncovered(cell, site)) return;
      visit(of.place(cell, site), of.skin_place(cell, site));
      ++count;
    });
  }
  return count;
}

options::PointBodyOptions polygon(const std::vector<Vector<2>>& corners, double spacing)
{
  options::PointBodyOptions body;
  body.name = "body";
  body.spacing = spacing;
  for (std::size_t k = 0; k < corners.size(); ++k)
    body.shape.border.push_back({corners[k], corners[(k + 1) % corners.size()]});
  return body;
}

TEST(PointSkin, OfADiscIsACircle)
{
  options::PointBodyOptions body;
  body.spacing = 0.1;
  body.shape.disc = options::PointShape::Ball{{0.3, -0.2, 0.0}, 1.03};
  EXPECT_GT(for_each_skin<2>(body,
                             [](const Vector<2>& site, const Vector<2>& skin) {
                               EXPECT_NEAR((skin - Vector<2>(0.3, -0.2)).norm(), 0.98, 1e-14);
                               EXPECT_LT((skin - site).norm(), 0.1);
                             }),
            50);
}

/// Sites at the hole of a thin ring stay where they are.
TEST(PointSkin, OfARingIsThatOfItsOuterBorder)
{
  options::PointBodyOptions body;
  body.spacing = 0.1;
  body.shape.disc = options::PointShape::Ball{{0.0, 0.0, 0.0}, 2.0};
  body.shape.holes = {{{0.0, 0.0, 0.0}, 1.8}};
  for_each_skin<2>(body, [](const Vector<2>& site, const Vector<2>& skin) {
    EXPECT_LT((skin - site).norm(), 0.07) << site.transpose();
    EXPECT_TRUE(site.norm() >= 1.85 || skin == site) << site.transpose();
  });
}

/// Cells of 2 with their middle within 1.1 of (1, 1) and of (7, 3): one each, of 16.
TEST(PointShape, HolesTakeTheCellsOfEach)
{
  options::PointBodyOptions body;
  body.spacing = 1.0;
  body.shape.box = geom::Box<3>{{0.0, 0.0, 0.0}, {8.0, 8.0, 0.0}};
  EXPECT_EQ(scene::body_of<2>(body, lattice(1.0), {}).count(), 64);
  body.shape.holes = {{{1.0, 1.0, 0.0}, 1.1}, {{7.0, 3.0, 0.0}, 1.1}};
  const auto of = scene::body_of<2>(body, lattice(1.0), {});
  EXPECT_EQ(of.count(), 64 - 8);
  for (std::size_t k = 0; k < of.points.size(); ++k) {
    const Site<2> cell = of.cell(static_cast<std::int64_t>(k));
    EXPECT_EQ(of.points[k] == 0, cell == (Site<2>{0, 0}) || cell == (Site<2>{3, 1})) << k;
  }
}

TEST(PointSkin, OfACylinderKeepsItsEnds)
{
  options::PointBodyOptions body;
  body.spacing = 0.1;
  body.shape.disc = options::PointShape::Ball{{0.0, 0.0, 0.0}, 0.53};
  body.shape.z_upper = 0.4;
  for_each_skin<3>(body, [](const Vector<3>& site, const Vector<3>& skin) {
    EXPECT_EQ(skin[2], site[2]);
    const bool inner = site[2] > 0.1 && site[2] < 0.3; // a site that only the rim leaves uncovered
    const double radius = skin.head<2>().norm();
    EXPECT_TRUE(std::abs(radius - 0.48) < 1e-14 || (!inner && skin == site)) << site.transpose();
  });
}

TEST(PointSkin, OfASphereIsASphere)
{
  options::PointBodyOptions body;
  body.spacing = 0.1;
  body.shape.sphere = options::PointShape::Ball{{0.0, 0.0, 0.5}, 0.53};
  for_each_skin<3>(body, [](const Vector<3>&, const Vector<3>& skin) {
    EXPECT_NEAR((skin - Vector<3>(0.0, 0.0, 0.5)).norm(), 0.48, 1e-14);
  });
}

/// Of a square that is turned, all lie on a smaller square, its corners too, whatever the angle.
TEST(PointSkin, OfATurnedSquareIsASquare)
{
  for (const double degrees : {0.0, 10.0, 18.0, 30.0, 45.0, 71.0}) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vector<2> along(std::cos(angle), std::sin(angle)), up(-along[1], along[0]);
    const auto body = polygon({along - up, along + up, up - along, -along - up}, 0.1);
    for_each_skin<2>(body, [&](const Vector<2>& site, const Vector<2>& skin) {
      const double depth = 1.0 - std::max(std::abs(skin.dot(along)), std::abs(skin.dot(up)));
      EXPECT_NEAR(depth, 0.05, 1e-9) << degrees << " degrees, " << site.transpose();
      EXPECT_LT((skin - site).norm(), 0.1 + 1e-9);
    });
  }
}

/// Sites on the border, too, know the side on which the body is; a re-entrant corner is rounded.
TEST(PointSkin, OfAnEllKeepsItsDistance)
{
  const auto body = polygon({{0, 0}, {2, 0}, {2, 1}, {1.05, 1}, {1, 1.05}, {1, 2}, {0, 2}}, 0.1);
  for_each_skin<2>(body, [&](const Vector<2>&, const Vector<2>& skin) {
    double nearest = 1.0;
    for (const auto& [a, b] : body.shape.border) {
      const double to = std::clamp((skin - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (skin - a - to * (b - a)).norm());
    }
    EXPECT_NEAR(nearest, 0.05, 1e-9) << skin.transpose();
    EXPECT_TRUE(skin[0] > 0.0 && skin[1] > 0.0 && (skin[0] < 1.06 || skin[1] < 1.06)) << skin.transpose();
  });
}

TEST(PointSkin, OfABoxIsItsSites)
{
  options::PointBodyOptions body;
  body.spacing = 0.1;
  body.shape.box = geom::Box<3>{Vector<3>::Zero(), {1.0, 0.5, 0.0}};
  for_each_skin<2>(body, [](const Vector<2>& site, const Vector<2>& skin) { EXPECT_EQ(site, skin); });
}
} // namespace test_point_shapes
