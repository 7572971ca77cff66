#include "pdx/couple/contact_law.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using couple::ContactLaw;

namespace test_contact_law {
couple::ContactOptions with_friction(double friction)
{
  couple::ContactOptions options;
  options.friction = friction;
  return options;
}

TEST(ContactLaw, IsAsStiffAsTheLayerThatBothHalvesMake)
{
  couple::ContactOptions plate;
  plate.thickness = 0.2;
  const ContactLaw<2> plane({{"a", 6.0}, {"b", 6.0}}, plate);
  EXPECT_NEAR(2.0 * plane.stiffness(0, 0.1, 1, 0.1), 6.0 * 0.2, 1e-15); // from either side: E t
  const ContactLaw<3> space({{"a", 6.0}, {"b", 6.0}}, {});
  EXPECT_NEAR(2.0 * space.stiffness(0, 0.1, 1, 0.1), 6.0 * 0.1, 1e-15); // E dx
  const ContactLaw<2> unlike({{"a", 1.0}, {"b", 3.0}}, {});
  const double modulus = 0.4 / (0.1 / 1.0 + 0.3 / 3.0), d0 = 0.2;
  EXPECT_NEAR(unlike.stiffness(0, 0.1, 1, 0.3), modulus * 0.1 * 0.3 / 0.4 / d0, 1e-15);
  EXPECT_EQ(unlike.stiffness(0, 0.1, 1, 0.3), unlike.stiffness(1, 0.3, 0, 0.1));
  couple::ContactOptions given;
  given.stiffness = 5.0;
  EXPECT_NEAR(2.0 * ContactLaw<2>({{"a", 1.0}, {"b", 3.0}}, given).stiffness(0, 0.1, 1, 0.1), 5.0, 1e-15);
}

/// Per unit of area a layer between bodies is E / d0 stiff, however the points of either share it out.
TEST(ContactLaw, SharesTheLayerOutBetweenSmallAndLargePoints)
{
  const ContactLaw<3> law({{"a", 2.0}, {"b", 2.0}}, {});
  for (const double large : {0.1, 0.2, 0.4}) {
    const double k = law.stiffness(0, 0.1, 1, large);
    EXPECT_NEAR(k / (0.1 * 0.1) + k / (large * large), 2.0 / (0.5 * (0.1 + large)), 1e-12);
  }
}

TEST(ContactLaw, AnyTwoBodiesMayTouchOrThoseGiven)
{
  const std::vector<couple::ContactBody> three{{"a", 1.0}, {"b", 1.0}, {"c", 1.0}};
  const ContactLaw<2> any(three, {});
  EXPECT_EQ(any.pairs(), (std::vector<std::array<Index, 2>>{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_EQ(any.pair(2, 1), 2);
  EXPECT_FALSE(any.may_touch(1, 1));
  couple::ContactOptions options;
  options.pairs = {{2, 0}, {0, 2}};
  const ContactLaw<2> given(three, options);
  EXPECT_EQ(given.pairs(), (std::vector<std::array<Index, 2>>{{0, 2}}));
  EXPECT_FALSE(given.may_touch(0, 1));
  EXPECT_FALSE(given.touches_any(1));
}

TEST(ContactLaw, ItsBoundIsThatOfTheCornerThatMeetsMostPoints)
{
  const ContactLaw<2> plane({{"a", 1.0}, {"b", 1.0}}, {});
  // k = 1/2; a point once, and a corner midway between two points of a face: sum n n^T has 2 (1 - 1/4)
  EXPECT_NEAR(plane.stiffness_bound(0, 1.0, 1, 1.0), 2.0 * 0.5 * (1.0 + 1.5), 1e-15);
  const ContactLaw<3> space({{"a", 1.0}, {"b", 1.0}}, {}); // above the middle of four: 4 (1 - 1/2)
  EXPECT_NEAR(space.stiffness_bound(0, 1.0, 1, 1.0), 2.0 * 0.5 * (1.0 + 2.0), 1e-15);
  // large segments before points half as far apart: 1 + 2 (1/2)
  const double k = plane.stiffness(0, 2.0, 1, 1.0);
  EXPECT_NEAR(plane.stiffness_bound(0, 2.0, 1, 1.0), 2.0 * k * (1.0 + 2.0), 1e-15);
  EXPECT_GT(ContactLaw<2>({{"a", 1.0}, {"b", 1.0}}, with_friction(0.1)).stiffness_bound(0, 1.0, 1, 1.0), 2.5);
}
} // namespace test_contact_law
