#include "pdx/scene/mixed_points.hpp"

#include "support/scene.hpp"

#include "pdx/adapt/conversion.hpp"
#include "pdx/scene/layout.hpp"

#include <algorithm>
#include <gtest/gtest.h>

using namespace pdx;
using test::Field;

namespace {
constexpr Index kCells = 10; // of the unit square, per side: coordinates are kept as decimals
constexpr double kCell = 1.0 / kCells;
constexpr couple::Scheme kCouplings[] = {couple::Scheme::energy, couple::Scheme::handshake};
constexpr double kSmall = 1e-12; // strain: what is not linear is as small

geom::Box<2> cells(Index x0, Index y0, Index x1, Index y1)
{
  return {kCell * Vector<2>(x0, y0), kCell * Vector<2>(x1, y1)};
}

/// Material points on the unit square, and what of it are particles.
options::SceneOptions square_of_points(const std::vector<geom::Box<2>>& patches, int finer = 1,
                                       couple::Scheme scheme = couple::Scheme::energy)
{
  options::SceneOptions options;
  options.elastic = test::plane_stress();
  options.elastic.density = 1.0;
  options.kinematics = options::KinematicsOption::finite;
  options.scheme = scheme;
  options.time.analysis = options::Analysis::explicit_dynamics;
  options::PointBodyOptions body;
  body.name = "square";
  body.shape.box = geom::Box<3>{{0.0, 0.0, 0.0}, {1.0, 1.0, 0.0}};
  body.elastic = options.elastic;
  body.spacing = 0.5 * kCell;
  options.points.bodies.push_back(body);
  for (const geom::Box<2>& patch : patches) options.pd.patches.push_back(patch);
  options.pd.spacing = {body.spacing / finer};
  return options;
}

/// Cells that have no pattern, off the border.
std::vector<geom::Box<2>> scattered()
{
  std::vector<geom::Box<2>> boxes;
  const Field noise = test::noise(7);
  for (Index j = 2; j < kCells - 2; ++j)
    for (Index i = 2; i < kCells - 2; ++i)
      if (noise(Vector<2>(i, j))[0] > 0.2) boxes.push_back(cells(i, j, i + 1, j + 1));
  return boxes;
}

/// Largest force on a row inside the body, over that on the side of a cell at the largest strain of the field.
double unbalanced(test::Scene& scene, const Field& field, double strain, bool everywhere = false)
{
  const std::vector<double> force = scene.internal_force(scene.blocks(field));
  double worst = 0.0;
  for (Index row = 0; row < scene.rows().owned(); ++row) {
    const Vector<2> x = scene.place(row);
    const bool inside = (x.array() > 1e-9).all() && (x.array() < 1.0 - 1e-9).all();
    if (!inside && !everywhere) continue;
    const auto at = static_cast<std::size_t>(2 * row);
    worst = std::max(worst, std::hypot(force[at], force[at + 1]));
  }
  const law::Elastic& e = scene.options().elastic;
  return scene.max(worst) / (e.young * strain * kCell * e.thickness);
}

Field turned(double angle)
{
  return test::affine(std::cos(angle) - 1.0, -std::sin(angle), std::sin(angle), std::cos(angle) - 1.0, {0.3, -0.2});
}
} // namespace

// mpm.md section 2: patch tests 7e-13 of block and scattered cells, rotation by half a radian to rounding.
TEST(MixedPoints, UniformStrainIsInBalance)
{
  for (const auto& patches : {std::vector{cells(4, 4, 8, 7)}, scattered()})
    for (const int finer : {1, 2}) {
      test::Scene scene(square_of_points(patches, finer));
      ASSERT_GT(scene.sum(static_cast<double>(scene.d().particles.size())), 0.0);
      ASSERT_NE(scene.d().points, nullptr);
      EXPECT_LT(unbalanced(scene, test::affine(kSmall, 0.0, 0.0, 0.0), kSmall), 1e-12);
      EXPECT_LT(unbalanced(scene, test::affine(0.0, kSmall, kSmall, -kSmall), kSmall), 1e-12);
    }
}

TEST(MixedPoints, RotationIsFreeOfForce)
{
  for (const auto& patches : {std::vector{cells(4, 4, 8, 7)}, scattered()})
    for (const couple::Scheme scheme : kCouplings) {
      test::Scene scene(square_of_points(patches, 1, scheme));
      EXPECT_LT(unbalanced(scene, turned(0.5), 1.0, true), 2e-12);
    }
}

// mpm.md section 2: the paper's handshake leaves .60 of E strain h at nodes beside a block, 1.15 beside scattered
// cells.
TEST(MixedPoints, HandshakeLeavesForcesInUniformStrain)
{
  const auto left = [](const std::vector<geom::Box<2>>& patches, double along, double across) {
    test::Scene scene(square_of_points(patches, 1, couple::Scheme::handshake));
    return unbalanced(scene, test::affine(along * kSmall, 0.0, 0.0, across * kSmall), kSmall);
  };
  EXPECT_NEAR(left({cells(4, 4, 8, 7)}, 1.0, 0.0), 0.60, 0.01);
  EXPECT_NEAR(left(scattered(), 1.0, 1.0), 1.15, 0.15); // other cells than there
}

// Of any displacement: forces add up to nothing.
TEST(MixedPoints, ForcesKeepMomentum)
{
  for (const couple::Scheme scheme : kCouplings) {
    test::Scene scene(square_of_points(scattered(), 1, scheme));
    const Field noise = test::noise(3);
    const std::vector<double> force =
        scene.internal_force(scene.blocks([&](const Vector<2>& x) { return Vector<2>(1e-3 * noise(x)); }));
    double sum[2] = {0.0, 0.0}, size = 0.0;
    for (std::size_t k = 0; k < force.size(); ++k) {
      sum[k % 2] += force[k];
      size += std::abs(force[k]);
    }
    EXPECT_LT(std::hypot(scene.sum(sum[0]), scene.sum(sum[1])), 1e-14 * scene.sum(size));
  }
}

// The mass of a body is that of its points, whatever of them are particles.
TEST(MixedPoints, MassIsThatOfTheBody)
{
  for (const auto& [patches, handed] : {std::pair{std::vector{cells(4, 4, 8, 7)}, false}, std::pair{scattered(), false},
                                        std::pair{scattered(), true}}) {
    options::SceneOptions options = square_of_points(patches);
    options.face_mass = handed;
    test::Scene scene(options);
    std::vector<double> mass(static_cast<std::size_t>(scene.rows().owned()), 0.0);
    for (const auto& term : scene.system().terms) term->add_mass(mass);
    double sum = 0.0;
    for (const double m : mass) sum += m;
    EXPECT_NEAR(scene.sum(sum) / scene.options().elastic.thickness, 1.0, 1e-13);
  }
}

// Of a bond with k spacings across the border, from a particle half a spacing before it, 1 - 1 / (2 k) lies outside.
TEST(MixedPoints, ParticlesHandMassToTheirBorder)
{
  options::SceneOptions options = square_of_points({cells(2, 2, 8, 8)});
  options.face_mass = true;
  test::Scene scene(options);
  const pd::Stencil<2>& stencil = scene.plan().stencils[0];
  double outside = 0.0, all = 0.0;
  for (const pd::Arm<2>& arm : stencil.half) {
    all += 2.0 * arm.kappa * arm.length;
    if (arm.step[0] != 0) outside += arm.kappa * arm.length * (1.0 - 0.5 / std::abs(arm.step[0]));
  }
  std::vector<double> mass(static_cast<std::size_t>(scene.rows().owned()), 0.0);
  for (const auto& term : scene.system().terms) term->add_mass(mass);
  const Vector<2> border(2.25 * kCell, 5.25 * kCell), deep(5.25 * kCell, 5.25 * kCell);
  int seen = 0;
  for (Index row = scene.rows().first_particle(); row < scene.rows().owned(); ++row) {
    const double share = mass[static_cast<std::size_t>(row)] / stencil.volume(); // of density 1
    const bool at_border = (scene.place(row) - border).norm() < 1e-9, inside = (scene.place(row) - deep).norm() < 1e-9;
    if (at_border || inside) {
      EXPECT_NEAR(share, at_border ? 1.0 - outside / all : 1.0, 1e-12);
    }
    seen += at_border || inside;
  }
  EXPECT_EQ(scene.sum(seen), 2.0);
}

namespace {
/// How many cells a field makes particles, by stress or by stretch.
std::size_t converted(test::Scene& scene, const adapt::ConversionRule& rule, const Field& field)
{
  const adapt::SceneView view = scene.d().view(scene.mesh());
  const auto elastic = [&](Index) -> const law::Elastic& { return scene.options().elastic; };
  adapt::BulkWatch watch(view, rule, {elastic});
  const std::vector<geom::LatticeAnchor> lattices{{Vector<2>::Zero(), 0.5 * kCell}};
  return adapt::conversion(view, watch, lattices, scene.blocks(field)).size();
}
} // namespace

// Principal stress and stretch of a uniform strain are known; what surrounds one cell that asks comes along.
TEST(Conversion, BulkAsksByWhatItBears)
{
  test::Scene scene(square_of_points({cells(5, 5, 7, 7)}));
  const law::Elastic& e = scene.options().elastic;
  const auto all = static_cast<std::size_t>(kCells * kCells - 4);
  const double strain = 0.01, stress = e.young * strain; // uniaxial along y
  const Field pulled = test::affine(-e.poisson * strain, 0.0, 0.0, strain);
  const Field turned_and_pulled = [&](const Vector<2>& x) -> Vector<2> {
    const Vector<2> y = x + pulled(x);
    return x + pulled(x) - x + turned(0.7)(y);
  };
  for (const Field& field : {pulled, turned_and_pulled}) {
    for (const double share : {0.999, 1.001}) {
      adapt::ConversionRule by_stress, by_stretch;
      by_stress.stress = share * stress;
      by_stretch.stretch = share * strain;
      EXPECT_EQ(converted(scene, by_stress, field), share < 1.0 ? all : 0U);
      EXPECT_EQ(converted(scene, by_stretch, field), share < 1.0 ? all : 0U);
    }
  }
  // Strain in the column of cells 2 to 3 along x alone.
  const Field one = [](const Vector<2>& x) -> Vector<2> {
    return {0.02 * std::clamp(x[0] - 2 * kCell, 0.0, kCell), 0.0};
  };
  adapt::ConversionRule rule;
  rule.stretch = 0.015;
  for (const int margin : {0, 1, 2}) {
    rule.margin = margin;
    EXPECT_EQ(converted(scene, rule, one), static_cast<std::size_t>(kCells * (1 + 2 * margin)));
  }
}
