#include "support/point_body.hpp"
#include "support/tangent.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

using namespace pdx;
using mpm::BodyMaterial;

namespace test_point_term {
constexpr double kYoung = 10.0;

template <int Dim> Site<Dim> box(Index a, Index b, Index c)
{
  if constexpr (Dim == 2)
    return {a, b};
  else
    return {a, b, c};
}
BodyMaterial material(int ratio = 2, mpm::Law law = mpm::Law::corotational, double spacing = 0.05)
{
  return {{kYoung, 0.3, law::Plane::stress, 0.7, 4.0}, law, spacing, ratio};
}
template <int Dim> Tensor<Dim> turned(double angle)
{
  if constexpr (Dim == 2)
    return Eigen::Rotation2Dd(angle).toRotationMatrix();
  else
    return Eigen::AngleAxisd(angle, Vector<3>(1.0, -2.0, 0.5).normalized()).toRotationMatrix();
}
template <int Dim> Tensor<Dim> strained()
{
  Tensor<Dim> h;
  for (int i = 0; i < Dim * Dim; ++i) h(i / Dim, i % Dim) = 0.02 * std::sin(1.0 + 2.0 * i);
  return h;
}
/// A smooth displacement of some per cent.
template <int Dim> Vector<Dim> wavy(const Vector<Dim>& x)
{
  Vector<Dim> u;
  for (int d = 0; d < Dim; ++d) u[d] = 0.02 * std::sin(5.0 * x.sum() + 7.0 * x[d] + 2.0 * d) + 0.1 * x[(d + 1) % Dim];
  return u;
}

template <class D> struct PointTerm : ::testing::Test {
  static constexpr int kDim = D::value;
  /// Bodies full and ragged, one point and more in a cell, both laws.
  static std::vector<test::PointBody<kDim>> bodies()
  {
    std::vector<test::PointBody<kDim>> all;
    const Site<kDim> cells = box<kDim>(11, 4, 3);
    for (const mpm::Law law : {mpm::Law::corotational, mpm::Law::neo_hooke})
      for (const int ratio : {1, 2, 3}) {
        if (kDim == 3 && ratio == 3) continue;
        all.emplace_back(PETSC_COMM_WORLD, cells, material(ratio, law));
        if (ratio == 1) continue;
        all.emplace_back(PETSC_COMM_WORLD, cells, material(ratio, law),
                         [=](const Site<kDim>& cell) { return test::mixed_mask<kDim>(cell, ratio); });
      }
    return all;
  }
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PointTerm, Dimensions);

double largest_of(const std::vector<double>& values)
{
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return test::largest(most);
}

TYPED_TEST(PointTerm, RigidMotionLeavesNoForceAndNoStress)
{
  constexpr int Dim = TestFixture::kDim;
  for (auto& body : this->bodies())
    for (const double angle : {0.0, 0.5, 3.0}) {
      const auto u = body.blocks([&](const Vector<Dim>& x) -> Vector<Dim> {
        return turned<Dim>(angle) * x - x + Vector<Dim>::Constant(angle > 0.0 ? 3.0 : 0.0);
      });
      EXPECT_LT(largest_of(body.force(u)), 1e-12 * kYoung);
      EXPECT_LT(largest_of(body.term().cauchy_stress(u)), 1e-12 * kYoung);
      EXPECT_LT(std::abs(test::sum(body.term().energy(u))), 1e-16 * kYoung);
    }
}

TYPED_TEST(PointTerm, UniformStrainIsExactWhateverPointsThereAre)
{
  constexpr int Dim = TestFixture::kDim;
  const Tensor<Dim> h = turned<Dim>(0.4) * (Tensor<Dim>::Identity() + strained<Dim>()) - Tensor<Dim>::Identity();
  for (auto& body : this->bodies()) {
    const BodyMaterial& m = body.term().materials()[0];
    const auto u = body.blocks([&](const Vector<Dim>& x) -> Vector<Dim> { return h * x; });
    const Tensor<Dim> p = mpm::law_stress<Dim>(m, h);
    const Tensor<Dim> cauchy =
        p * (Tensor<Dim>::Identity() + h).transpose() / (Tensor<Dim>::Identity() + h).determinant();
    const auto stress = body.term().cauchy_stress(u), f = body.term().deformation(u);
    for (std::size_t k = 0; k < stress.size(); ++k) {
      const auto c = static_cast<int>(k) % (Dim * Dim);
      EXPECT_NEAR(stress[k], cauchy(c / Dim, c % Dim), 1e-13 * kYoung);
      EXPECT_NEAR(f[k], h(c / Dim, c % Dim) + (c / Dim == c % Dim), 1e-13);
    }
    // What a node feels is P times the sum of V grad N over the points around it.
    std::vector<double> expected(static_cast<std::size_t>(body.halo().size()) * Dim, 0.0);
    const auto cells = body.term().cells();
    for (const mpm::PointCell<Dim>& cell : cells)
      mpm::for_each_point(cell.points, [&](int site) {
        const auto g = mpm::hat_gradients<Dim>(mpm::site_place<Dim>(m.ratio, site), m.side());
        for (int a = 0; a < mpm::kCorners<Dim>; ++a) {
          const Vector<Dim> force = mpm::point_volume<Dim>(m) * (p * g.row(a).transpose());
          const auto row = static_cast<std::size_t>(body.halo().local(cell.rows[static_cast<std::size_t>(a)]));
          for (int d = 0; d < Dim; ++d) expected[row * Dim + static_cast<std::size_t>(d)] += force[d];
        }
      });
    body.halo().reduce(expected, Dim);
    const auto force = body.force(u);
    const double size = kYoung * 0.02 * m.side() * (Dim == 2 ? m.elastic.thickness : m.side());
    for (std::size_t i = 0; i < force.size(); ++i) EXPECT_NEAR(force[i], expected[i], 1e-12 * size);
    double sum = 0.0; // energy
    for (const double mass : body.term().masses()) sum += mass / m.elastic.density * mpm::law_energy<Dim>(m, h);
    EXPECT_NEAR(test::sum(body.term().energy(u)) / test::sum(sum), 1.0, 1e-12);
  }
}

TYPED_TEST(PointTerm, NodesInsideFullCellsFeelNoUniformStrain)
{
  constexpr int Dim = TestFixture::kDim;
  for (const int ratio : {1, 2}) {
    test::PointBody<Dim> body(PETSC_COMM_WORLD, box<Dim>(11, 4, 3), material(ratio));
    const double h = material(ratio).side();
    const auto u = body.blocks([&](const Vector<Dim>& x) -> Vector<Dim> { return strained<Dim>() * x; });
    const auto force = body.force(u);
    const Vector<Dim> top = h * (Dim == 2 ? Vector<3>(11.0, 4.0, 0.0) : Vector<3>(11.0, 4.0, 3.0)).template head<Dim>();
    Index inside = 0;
    for (std::size_t n = 0; n < body.nodes().size(); ++n) {
      const Vector<Dim>& x = body.nodes()[n];
      if (x.minCoeff() < 1e-9 || (top - x).minCoeff() < 1e-9) continue;
      ++inside;
      for (std::size_t d = 0; d < Dim; ++d) EXPECT_NEAR(force[n * Dim + d], 0.0, 1e-12 * kYoung * 0.02 * h);
    }
    EXPECT_EQ(test::sum(inside), Dim == 2 ? 30.0 : 60.0);
  }
}

TYPED_TEST(PointTerm, ForcesHaveNoResultantAndNoMoment)
{
  constexpr int Dim = TestFixture::kDim;
  for (auto& body : this->bodies()) {
    const auto u = body.blocks(wavy<Dim>);
    const auto force = body.force(u);
    Vector<3> sum = Vector<3>::Zero(), moment = Vector<3>::Zero();
    double size = 0.0;
    for (std::size_t n = 0; n < body.nodes().size(); ++n) {
      Vector<3> f = Vector<3>::Zero(), x = Vector<3>::Zero();
      for (int d = 0; d < Dim; ++d) {
        f[d] = force[n * Dim + static_cast<std::size_t>(d)];
        x[d] = body.nodes()[n][d] + u[n * Dim + static_cast<std::size_t>(d)];
      }
      sum += f;
      moment += x.cross(f);
      size += f.norm();
    }
    size = test::sum(size);
    EXPECT_GT(size, 1e-3);
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(test::sum(sum[d]), 0.0, 1e-14 * size);
      EXPECT_NEAR(test::sum(moment[d]), 0.0, 1e-14 * size);
    }
  }
}

TYPED_TEST(PointTerm, ForcesAreTheSlopeOfTheEnergy)
{
  constexpr int Dim = TestFixture::kDim;
  const double step = 1e-4;
  const auto direction = [](const Vector<Dim>& x) -> Vector<Dim> {
    return 0.1 * wavy<Dim>(Vector<Dim>(3.0 * x + Vector<Dim>::Ones()));
  };
  for (auto& body : this->bodies()) {
    const auto at = [&](double by) {
      return test::sum(body.term().energy(
          body.blocks([&](const Vector<Dim>& x) -> Vector<Dim> { return wavy<Dim>(x) + by * step * direction(x); })));
    };
    const double slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * step);
    const auto force = body.force(body.blocks(wavy<Dim>));
    double work = 0.0, size = 0.0;
    for (std::size_t n = 0; n < body.nodes().size(); ++n)
      for (int d = 0; d < Dim; ++d) {
        const double part = force[n * Dim + static_cast<std::size_t>(d)] * direction(body.nodes()[n])[d];
        work += part;
        size += std::abs(part);
      }
    EXPECT_NEAR(test::sum(work), slope, 1e-9 * test::sum(size));
  }
}

TYPED_TEST(PointTerm, TangentTimesStepIsTheChangeOfTheForce)
{
  constexpr int Dim = TestFixture::kDim;
  const double step = 1e-5;
  const auto direction = [](const Vector<Dim>& x) -> Vector<Dim> {
    return wavy<Dim>(Vector<Dim>(3.0 * x + Vector<Dim>::Ones()));
  };
  for (auto& body : this->bodies()) {
    const auto moved = [&](double by) {
      return body.force(
          body.blocks([&](const Vector<Dim>& x) -> Vector<Dim> { return wavy<Dim>(x) + by * step * direction(x); }));
    };
    const auto after = moved(1.0), before = moved(-1.0);
    const std::vector<std::uint8_t> held(static_cast<std::size_t>(body.halo().size()) * Dim, 0);
    const MatHandle k = test::tangent_of({&body.term()}, body.halo(), held, body.blocks(wavy<Dim>), 1.0);
    VecHandle d = body.rows().vector(), y = body.rows().vector();
    const auto turn = body.blocks(direction);
    field::set_owned_values(d.get(), std::span(turn).first(after.size()));
    PDX_CALL(MatMult(k.get(), d.get(), y.get()));
    const auto found = field::owned_values(y.get());
    const double size = largest_of(found);
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_NEAR(found[i], (after[i] - before[i]) / (2.0 * step), 1e-7 * size);
    PetscBool symmetric = PETSC_FALSE;
    PDX_CALL(MatIsSymmetric(k.get(), 1e-12 * kYoung, &symmetric));
    EXPECT_TRUE(symmetric);
    EXPECT_TRUE(body.term().symmetric());
  }
}

TYPED_TEST(PointTerm, ForcesAndEnergyDoNotDependOnWhoHasWhat)
{
  constexpr int Dim = TestFixture::kDim;
  const auto mask = [](const Site<Dim>& cell) {
    return cell[1] == 0 ? test::mixed_mask<Dim>(cell, 2) : mpm::full_mask<Dim>(2);
  };
  const Site<Dim> cells = box<Dim>(13, 5, 3);
  test::PointBody<Dim> alone(PETSC_COMM_SELF, cells, material(), mask), body(PETSC_COMM_WORLD, cells, material(), mask);
  const auto u = body.blocks(wavy<Dim>), whole_u = alone.blocks(wavy<Dim>);
  const auto force = body.force(u), whole = alone.force(whole_u), mass = body.mass(), whole_mass = alone.mass();
  const auto first = static_cast<std::size_t>(body.rows().first);
  for (std::size_t i = 0; i < force.size(); ++i) EXPECT_NEAR(force[i], whole[first * Dim + i], 1e-14 * kYoung * 0.1);
  for (std::size_t n = 0; n < mass.size(); ++n) EXPECT_NEAR(mass[n], whole_mass[first + n], 1e-15);
  const double energy = alone.term().energy(whole_u);
  EXPECT_NEAR(test::sum(body.term().energy(u)), energy, 1e-13 * energy);
  EXPECT_EQ(test::sum(body.term().points()), alone.term().points());
}

TYPED_TEST(PointTerm, MassesOfNodesAreThoseOfPoints)
{
  constexpr int Dim = TestFixture::kDim;
  for (auto& body : this->bodies()) {
    double of_nodes = 0.0, of_points = 0.0;
    Vector<Dim> centre = Vector<Dim>::Zero(); // times the mass: hats of linear functions are exact
    const auto mass = body.mass(), place = body.term().positions(body.corners()), own = body.term().masses();
    for (std::size_t n = 0; n < mass.size(); ++n) {
      EXPECT_GT(mass[n], 0.0);
      of_nodes += mass[n];
      centre += mass[n] * body.nodes()[n];
    }
    for (std::size_t p = 0; p < own.size(); ++p) {
      of_points += own[p];
      for (int d = 0; d < Dim; ++d) centre[d] -= own[p] * place[p * Dim + static_cast<std::size_t>(d)];
    }
    EXPECT_NEAR(test::sum(of_nodes) / test::sum(of_points), 1.0, 1e-14);
    for (int d = 0; d < Dim; ++d) EXPECT_NEAR(test::sum(centre[d]), 0.0, 1e-14);
  }
}

TYPED_TEST(PointTerm, PointsMoveWithLinearFields)
{
  constexpr int Dim = TestFixture::kDim;
  for (auto& body : this->bodies()) {
    const auto u = body.blocks([&](const Vector<Dim>& x) -> Vector<Dim> { return strained<Dim>() * x; });
    const auto moved = body.term().interpolated(u), place = body.term().positions(body.corners());
    ASSERT_EQ(place.size(), static_cast<std::size_t>(body.term().points()) * Dim);
    for (std::size_t p = 0; p < place.size(); p += Dim) {
      const Eigen::Map<const Vector<Dim>> x(place.data() + p), d(moved.data() + p);
      EXPECT_LT((d - strained<Dim>() * x).norm(), 1e-15);
    }
  }
}
} // namespace test_point_term
