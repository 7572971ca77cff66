#include "pdx/base/gather.hpp"
#include "support/touching_blocks.hpp"

using namespace pdx;
using test::Touching;

namespace test_contact_friction {
/// The whole turned about the origin in the plane of x and y.
template <int Dim> Vector<Dim> turned(const Vector<Dim>& x, double angle)
{
  Vector<Dim> y = x;
  y[0] = std::cos(angle) * x[0] - std::sin(angle) * x[1];
  y[1] = std::sin(angle) * x[0] + std::cos(angle) * x[1];
  return y;
}

/// Pressed together and dragged along, then turned as a whole.
template <int Dim> auto turned_and_dragged(double angle, double along)
{
  return [=](const typename Touching<Dim>::Row& row) -> Vector<Dim> {
    Vector<Dim> x = row.x + test::pressed<Dim>(row);
    if (row.body == 1) x[0] += along;
    return turned<Dim>(x, angle) - row.x;
  };
}

template <class T> class ContactFriction : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ContactFriction, Dimensions);

TYPED_TEST(ContactFriction, TurnsWithTheBodies)
{
  constexpr int kDim = TypeParam::value;
  couple::ContactOptions options;
  options.friction = 5.0;
  Touching<kDim> scene(PETSC_COMM_WORLD, test::touching_blocks<kDim>(), options);
  (void)scene.contact_force(scene.blocks(turned_and_dragged<kDim>(0.0, 0.0)));
  (void)scene.contact->slip();
  (void)scene.contact_force(scene.blocks(turned_and_dragged<kDim>(0.0, 0.03)));
  const Vector<kDim> before = scene.push(1, 0);
  (void)scene.contact->slip();
  for (const double angle : {0.5, 1.0, 2.0}) {
    (void)scene.contact_force(scene.blocks(turned_and_dragged<kDim>(angle, 0.03)));
    EXPECT_EQ(scene.sum(scene.contact->slip()), 0.0);
    EXPECT_NEAR((scene.push(1, 0) - turned<kDim>(before, angle)).norm(), 0.0, 1e-13);
  }
}

TYPED_TEST(ContactFriction, IsAtMostItsShareOfTheNormalForce)
{
  constexpr int kDim = TypeParam::value;
  Site<kDim> wide, narrow;
  wide.fill(8), narrow.fill(4);
  Vector<kDim> corner = Vector<kDim>::Constant(2.2);
  corner[1] = 8.0;
  couple::ContactOptions options;
  options.friction = 0.3;
  Touching<kDim> scene(PETSC_COMM_WORLD, {{"below", Vector<kDim>::Zero(), wide}, {"above", corner, narrow}}, options);
  double lost = 0.0, expected = 0.0;
  constexpr double kStep = 1e-3;
  for (int k = 0; k < 100; ++k) { // 0.1 m along x, across the border of facets
    (void)scene.contact_force(scene.blocks([&](const auto& row) -> Vector<kDim> {
      if (row.body == 0) return Vector<kDim>::Zero();
      return -0.01 * Vector<kDim>::Unit(1) + kStep * k * Vector<kDim>::Unit(0);
    }));
    lost += scene.sum(scene.contact->slip());
    const Vector<kDim> push = scene.push(1, 0);
    EXPECT_LE(-push[0], 0.3 * push[1] * (1.0 + 1e-12));
    if (k <= 24) continue; // stretched by mu / kStick of the overlap
    EXPECT_NEAR(-push[0], 0.3 * push[1], 1e-6 * push[1]);
    expected += 0.3 * push[1] * kStep;
  }
  EXPECT_NEAR(lost, expected, 1e-3 * expected);
}

TYPED_TEST(ContactFriction, GripsGoByNameToOtherRanks)
{
  constexpr int kDim = TypeParam::value;
  couple::ContactOptions options;
  options.friction = 0.1;
  Touching<kDim> scene(PETSC_COMM_WORLD, test::touching_blocks<kDim>(), options),
      alone(PETSC_COMM_SELF, test::touching_blocks<kDim>(), options);
  for (const double along : {0.0, 0.01, 0.02, 0.05}) {
    (void)scene.contact_force(scene.blocks(turned_and_dragged<kDim>(0.0, along)));
    (void)scene.contact->slip();
  }
  alone.contact->set_grips(gather_all(PETSC_COMM_WORLD, scene.contact->grips()));
  const auto next = turned_and_dragged<kDim>(0.0, 0.052);
  EXPECT_EQ(scene.contact_force(scene.blocks(next)), alone.contact_force(alone.blocks(next)));
  EXPECT_NEAR(scene.sum(scene.contact->slip()), alone.contact->slip(), 1e-15);
}

TYPED_TEST(ContactFriction, IsTheDerivativeOfItsEnergyAndNeitherPushesNorTurnsTheWhole)
{
  constexpr int kDim = TypeParam::value;
  couple::ContactOptions options;
  options.friction = 5.0; // nothing slips below
  Touching<kDim> scene(PETSC_COMM_WORLD, test::touching_blocks<kDim>(), options);
  (void)scene.contact_force(scene.blocks(test::pressed<kDim>));
  EXPECT_EQ(scene.sum(scene.contact->slip()), 0.0);
  EXPECT_GT(scene.sum(static_cast<double>(scene.contact->grips().size())), 3.0);
  const auto dragged = [](const auto& row) {
    Vector<kDim> u = test::pressed<kDim>(row);
    if (row.body == 1) {
      u[0] += 0.03;
      u[kDim - 1] += kDim == 3 ? 0.02 : 0.0;
    }
    return u;
  };
  test::expect_balance<kDim>(scene, scene.blocks(dragged));
  test::expect_derivative<kDim>(scene, dragged);
  EXPECT_EQ(scene.sum(scene.contact->slip()), 0.0);
  EXPECT_LT(scene.push(1, 0)[0], -0.01);
}
} // namespace test_contact_friction
