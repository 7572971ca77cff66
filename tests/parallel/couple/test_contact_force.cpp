#include "pdx/base/events.hpp"
#include "support/ranks.hpp"
#include "support/refusal.hpp"
#include "support/touching_blocks.hpp"

using namespace pdx;
using test::Touching;

template <class T> class ContactForce : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ContactForce, Dimensions);

TYPED_TEST(ContactForce, OfTwoLonePointsIsThatOfASpring)
{
  constexpr int kDim = TypeParam::value;
  Site<kDim> one;
  one.fill(1);
  Vector<kDim> beside = Vector<kDim>::Zero();
  beside[0] = 0.5;
  Touching<kDim> scene(PETSC_COMM_WORLD,
                       {{"left", Vector<kDim>::Zero(), one, 0.5, 4.0}, {"right", beside, one, 0.5, 4.0}});
  const double k = kDim == 2 ? 4.0 : 4.0 * 0.5; // E t, E dx
  for (const double gap : {-0.1, -0.01, 0.0, 0.1}) {
    const auto u = scene.blocks([&](const auto& row) {
      Vector<kDim> moved = Vector<kDim>::Zero();
      if (row.body == 1) moved = (0.5 + gap) * Vector<kDim>::Unit(1) - 0.5 * Vector<kDim>::Unit(0); // above the first
      return moved;
    });
    const std::vector<double> force = scene.contact_force(u);
    const double overlap = std::max(0.0, -gap);
    EXPECT_NEAR(force[1], k * overlap, 1e-7 * k); // 1e-8 of d0 are left to rounding
    EXPECT_NEAR(force[0], 0.0, 1e-15);
    EXPECT_EQ(force[kDim + 1], -force[1]);
    EXPECT_NEAR(scene.sum(scene.contact->energy(u)), 0.5 * k * overlap * overlap, 1e-8 * k);
    EXPECT_NEAR(scene.push(0, 1)[1], -k * overlap, 1e-7 * k);
    if (gap >= 0.0) {
      EXPECT_EQ(force[1], 0.0);
    }
  }
}

TYPED_TEST(ContactForce, IsTheDerivativeOfItsEnergyAndNeitherPushesNorTurnsTheWhole)
{
  constexpr int kDim = TypeParam::value;
  Touching<kDim> scene(PETSC_COMM_WORLD, test::touching_blocks<kDim>());
  test::expect_balance<kDim>(scene, scene.blocks(test::pressed<kDim>));
  test::expect_derivative<kDim>(scene, test::pressed<kDim>);
}

TYPED_TEST(ContactForce, IsTheSameToTheLastBitOnAnyNumberOfRanks)
{
  constexpr int kDim = TypeParam::value;
  for (const double friction : {0.0, 0.2}) {
    couple::ContactOptions options;
    options.friction = friction;
    Touching<kDim> together(PETSC_COMM_WORLD, test::touching_blocks<kDim>(), options),
        alone(PETSC_COMM_SELF, test::touching_blocks<kDim>(), options);
    for (const double along : {0.0, 0.05, 0.3}) {
      const auto moved = [&](const auto& row) {
        Vector<kDim> u = test::pressed<kDim>(row);
        if (row.body == 1) u[0] += along;
        return u;
      };
      EXPECT_EQ(together.contact_force(together.blocks(moved)), alone.contact_force(alone.blocks(moved)));
      EXPECT_NEAR(together.sum(together.contact->slip()), alone.contact->slip(), 1e-15);
    }
  }
}

TYPED_TEST(ContactForce, OfAFaceIsThatOfAnElasticLayerWhereverPointsStand)
{
  constexpr int kDim = TypeParam::value;
  Site<kDim> wide, narrow;
  wide.fill(10), narrow.fill(4);
  wide[1] = narrow[1] = 2;
  Vector<kDim> corner = Vector<kDim>::Constant(3.0);
  corner[1] = 2.0;
  Touching<kDim> scene(PETSC_COMM_WORLD,
                       {{"below", Vector<kDim>::Zero(), wide, 1.0, 3.0}, {"above", corner, narrow, 1.0, 3.0}});
  const double area = kDim == 2 ? 4.0 : 16.0, overlap = 0.01;
  for (const double along : {0.0, 0.25, 0.5, 1.3}) {
    const auto u = scene.blocks([&](const auto& row) {
      Vector<kDim> moved = Vector<kDim>::Constant(along);
      moved[1] = -overlap;
      return row.body == 1 ? moved : Vector<kDim>::Zero();
    });
    const std::vector<double> force = scene.contact_force(u);
    const Vector<kDim> push = scene.push(1, 0);
    const double before_skin = along == 0.0 ? 1.0 : std::pow(0.75, kDim - 1); // of the points below
    EXPECT_NEAR(push[1], 3.0 * area * overlap * 0.5 * (1.0 + before_skin), 1e-6) << along;
    EXPECT_NEAR(push[0], 0.0, 1e-14);
    for (std::size_t k = 0; k < scene.rows.size(); ++k)
      if (scene.rows[k].body == 1) {
        EXPECT_NEAR(force[k * kDim], 0.0, 1e-14);
      }
  }
}

TEST(ContactForce, OfUnlikeSizesIsThatOfTheLayerToo)
{
  Touching<2> scene(PETSC_COMM_WORLD,
                    {{"below", {0.0, 0.0}, {40, 2}, 0.5, 4.0}, {"above", {4.0, 1.0}, {4, 2}, 2.0, 1.0}});
  const auto u = scene.blocks([](const auto& row) -> Vector<2> { return {0.0, row.body == 1 ? -0.01 : 0.0}; });
  (void)scene.contact_force(u);
  const double modulus = 2.5 / (0.5 / 4.0 + 2.0 / 1.0), d0 = 1.25; // in series
  const double of_small = 2.0 / 2.5, before_skin = 12.0 / 16.0;    // what the small points bear, and how many of them
  EXPECT_NEAR(scene.push(1, 0)[1], modulus * 8.0 * 0.01 / d0 * (of_small * before_skin + 1.0 - of_small), 1e-6);
}

TEST(ContactForce, BodiesThatBeginInTouchPushNothing)
{
  Touching<2> scene(PETSC_COMM_WORLD,
                    {{"below", {0.1, 0.3}, {7, 3}, 0.1, 1.0}, {"above", {0.137, 0.6}, {3, 3}, 0.1, 1.0}});
  for (const double f : scene.contact_force(scene.blocks([](const auto&) -> Vector<2> { return {0.3, 0.3}; })))
    EXPECT_EQ(f, 0.0);
}

/// The lower body's stair and the upper body's fill up a square: the skins are nearer than points are.
TEST(ContactForce, AlsoAlongAStairOfACommonLattice)
{
  const auto body = [](Index number, bool below) {
    std::vector<couple::SkinPoint<2>> points;
    for (Index i = 0; i < 6; ++i)
      for (Index j = 0; j < 6; ++j)
        if ((j <= i) == below)
          points.push_back({static_cast<std::uint64_t>(36 * number + 6 * i + j), number, {0.1 * i, 0.1 * j}, 0.1});
    return points;
  };
  std::vector<couple::SkinPoint<2>> points = body(0, true);
  for (const auto& point : body(1, false)) points.push_back(point);
  const couple::ContactSkin<2> skin(points, 2);
  const couple::ContactLaw<2> law({{"below", 1.0}, {"above", 1.0}}, {});
  const std::vector<couple::StartOffset> offsets = couple::start_offsets(skin, law);
  EXPECT_EQ(offsets.size(), 9U); // of the upper body 5 points, of the lower one 4 lie in notches
  for (const couple::StartOffset& offset : offsets) EXPECT_NEAR(offset.less, 0.1 * (1.0 - std::sqrt(0.5)), 1e-8);
}

TEST(ContactForce, BodiesThatOverlapAreRefused)
{
  const auto with_gap = [](double gap) {
    return test::refusal([&] {
      Touching<2>(PETSC_COMM_WORLD,
                  {{"plate", {0.0, 0.0}, {6, 3}, 0.1, 1.0}, {"striker", {0.2, 0.3 + gap}, {3, 3}, 0.1, 1.0}});
    });
  };
  EXPECT_EQ(with_gap(0.0), "none");
  EXPECT_EQ(with_gap(-1e-12), "none");
  EXPECT_EQ(with_gap(-0.02), "bodies plate and striker overlap at the start: points at (0.25, 0.25) and (0.25, 0.33) "
                             "are 0.08 m apart, and need 0.1 m; move the bodies apart");
}

TEST(ContactForce, OnlyPairsThatMayTouchDo)
{
  couple::ContactOptions options;
  options.pairs = {{2, 0}};
  const test::TouchingBody<2> a{"a", {0.0, 0.0}, {4, 2}}, b{"b", {0.0, 1.0}, {4, 2}}, c{"c", {0.0, 3.5}, {4, 2}};
  Touching<2> scene(PETSC_COMM_WORLD, {a, b, c}, options); // a and b overlap
  EXPECT_EQ(scene.contact->law().pairs().size(), 1U);
  (void)scene.contact_force(scene.blocks([](const auto& row) -> Vector<2> {
    return {0.0, row.body == 2 ? -1.6 : 0.0};
  }));
  EXPECT_NEAR(scene.push(2, 0)[1], 0.1 * 4.0, 1e-6);
}

TEST(ContactForce, APairApartPaysNothing)
{
  const auto count = [](const char* name) {
    const auto counts = event_counts();
    const auto at = counts.find(name);
    return at == counts.end() ? 0 : at->second.count;
  };
  Touching<2> scene(PETSC_COMM_WORLD, {{"a", {0.0, 0.0}, {6, 3}}, {"b", {0.0, 9.0}, {6, 3}}});
  const int forces = count("contact_force"), searches = count("contact_search");
  const auto at = [&](double x, double y) {
    (void)scene.contact_force(scene.blocks([&](const auto& row) -> Vector<2> {
      return {row.body == 1 ? x : 0.0, row.body == 1 ? y : 0.0};
    }));
  };
  for (int k = 0; k < 20; ++k) at(0.1 * k, 0.0); // 6 m of gap: they do not come near
  EXPECT_EQ(count("contact_force"), forces);
  EXPECT_EQ(count("contact_search"), searches + (scene.contact->points() > 0 ? 1 : 0));
  at(0.0, -6.1);
  EXPECT_NEAR(scene.push(1, 0)[1], 0.6, 1e-6);
  EXPECT_EQ(count("contact_force"), forces + (scene.contact->points() > 0 ? 1 : 0));
}

TEST(ContactForce, FacetsThatAreTornHoldNothing)
{
  Touching<2> scene(PETSC_COMM_WORLD, {{"net", {0.0, 0.0}, {4, 1}}, {"ball", {2.0, 2.0}, {1, 1}}});
  const auto force = [&](double apart) { // the right half of the net goes away, the ball falls into the gap
    const auto u = scene.blocks([&](const auto& row) -> Vector<2> {
      if (row.body == 1) return {-0.5 + 0.5 * apart, -1.1};
      return {row.x[0] > 2.0 ? apart : 0.0, 0.0};
    });
    (void)scene.contact_force(u);
    return scene.push(1, 0)[1];
  };
  EXPECT_NEAR(force(0.5), 0.5 * 0.1, 1e-7); // of the ball before the net; the net's points do not reach it
  EXPECT_EQ(force(1.5), 0.0);
}
