#include "pdx/couple/contact_touch.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using couple::ContactSkin;
using couple::SkinPoint;

namespace test_contact_skin {
std::vector<Index> sizes_of_facets(const auto& skin)
{
  std::vector<Index> counts(4, 0);
  for (Index f = 0; f < skin.facets(); ++f) ++counts[static_cast<std::size_t>(skin.facet(f).count)];
  return counts;
}

/// A flat lattice in the plane z = 0.
std::vector<SkinPoint<3>> sheet(Index nx, Index ny)
{
  std::vector<SkinPoint<3>> points;
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i)
      points.push_back({static_cast<std::uint64_t>(points.size()), 0, {0.1 * i, 0.1 * j, 0.0}, 0.1});
  return points;
}

/// Where a point of size 0.1 touches what the points span [m].
template <int Dim> couple::Touch<Dim> touch(std::vector<SkinPoint<Dim>> points, const Vector<Dim>& x)
{
  points.push_back({1000, 1, x, 0.1});
  std::vector<Vector<Dim>> places;
  for (const auto& point : points) places.push_back(point.place);
  const ContactSkin<Dim> skin(points, 2);
  std::vector<Index> facets;
  for (Index f = 0; f < skin.facets(); ++f)
    if (skin.point(skin.facet(f).points[0]).body == 0) facets.push_back(f);
  return couple::deepest_touch<Dim>(skin, facets, places, static_cast<Index>(points.size()) - 1);
}

TEST(ContactSkin, OfARowIsAChain)
{
  std::vector<SkinPoint<2>> points;
  for (Index i = 0; i < 5; ++i) points.push_back({static_cast<std::uint64_t>(i), 0, {0.1 * i, 0.0}, 0.1});
  points.push_back({7, 0, {2.0, 0.0}, 0.1});
  points.push_back({8, 1, {0.1, 0.1}, 0.1});
  const ContactSkin<2> skin(points, 2);
  EXPECT_EQ(sizes_of_facets(skin), (std::vector<Index>{0, 2, 4, 0})); // two points have no neighbour of their body
  EXPECT_EQ(skin.facets_at(2).size(), 2U);
  EXPECT_EQ(skin.sizes(0).size(), 1U);
}

TEST(ContactSkin, OfASheetIsTwoTrianglesForEachSquare)
{
  const ContactSkin<3> skin(sheet(4, 3), 1);
  EXPECT_EQ(sizes_of_facets(skin), (std::vector<Index>{0, 0, 0, 12}));
}

TEST(ContactSkin, OfALineOfPointsInSpaceIsAChain)
{
  EXPECT_EQ(sizes_of_facets(ContactSkin<3>(sheet(4, 1), 1)), (std::vector<Index>{0, 0, 3, 0}));
}

TEST(ContactTouch, AFaceIsFlatWhereverAPointStands)
{
  for (const double x : {0.0, 0.03, 0.05, 0.1, 0.17})
    for (const double y : {0.0, 0.04, 0.11}) {
      const couple::Touch<3> here = touch<3>(sheet(4, 3), {x, y, 0.08});
      EXPECT_NEAR(here.overlap, 0.02, 2e-9);
      EXPECT_NEAR((here.normal - Vector<3>::Unit(2)).norm(), 0.0, 1e-14);
    }
}

TEST(ContactTouch, AStairOfALatticeIsASlope)
{
  std::vector<SkinPoint<3>> stair;
  for (Index k = 0; k < 5; ++k)
    for (Index i = 0; i < 4; ++i)
      stair.push_back({static_cast<std::uint64_t>(stair.size()), 0, {0.1 * i, 0.1 * k, 0.1 * k}, 0.1});
  const Vector<3> up = Vector<3>(0.0, -1.0, 1.0).normalized();
  for (const double along : {0.1, 0.13, 0.15, 0.2})
    for (const double rise : {0.1, 0.14, 0.25}) {
      const couple::Touch<3> here = touch<3>(stair, Vector<3>(along, rise, rise) + 0.09 * up);
      EXPECT_NEAR(here.overlap, 0.01, 2e-9);
      EXPECT_NEAR((here.normal - up).norm(), 0.0, 1e-13);
    }
}

TEST(ContactTouch, BeyondAnEdgeItIsRound)
{
  const couple::Touch<3> here = touch<3>(sheet(4, 3), {0.3 + 0.03, 0.1, 0.04});
  EXPECT_NEAR(here.distance, 0.05, 1e-15);
  EXPECT_NEAR((here.normal - Vector<3>(0.6, 0.0, 0.8)).norm(), 0.0, 1e-14);
  EXPECT_LT(touch<3>(sheet(4, 3), {0.41, 0.1, 0.0}).facet, 0);
}
} // namespace test_contact_skin
