#include "support/uniform_strain.hpp"

#include <gtest/gtest.h>

namespace pdx::test::patch_shapes {
namespace {
constexpr double kExact = 1e-10; // relative, all rows
constexpr Index kCells = 16;     // of the unit square, per side
constexpr double kElement = 1.0 / kCells;

struct Shape {
  const char* name;
  std::vector<geom::Box<2>> boxes;
};

geom::Box<2> box(Index x0, Index y0, Index x1, Index y1) ///< in elements
{
  return {kElement * Vector<2>(x0, y0), kElement * Vector<2>(x1, y1)};
}

/// Sides at even numbers of elements, so that spacings of 2/5 of one fit.
const Shape kShapes[] = {
    {"L", {box(4, 4, 12, 8), box(4, 8, 8, 12)}},
    {"T", {box(4, 10, 12, 12), box(6, 4, 8, 10)}},
    {"ring", {box(2, 2, 14, 4), box(2, 12, 14, 14), box(2, 4, 4, 12), box(12, 4, 14, 12)}},
    {"narrow ring", {box(4, 4, 10, 6), box(4, 8, 10, 10), box(4, 6, 6, 8), box(8, 6, 10, 8)}},
    {"U with a narrow notch", {box(4, 4, 10, 6), box(4, 6, 6, 12), box(8, 6, 10, 12)}},
    {"staircase of overlapping boxes", {box(2, 2, 6, 6), box(4, 4, 10, 8), box(8, 6, 14, 12)}},
    {"cross", {box(2, 6, 14, 8), box(6, 2, 8, 14)}},
    {"corner", {box(4, 4, 8, 8), box(8, 8, 12, 12)}},
    {"two that share part of an edge", {box(4, 4, 8, 10), box(8, 6, 12, 12)}},
};

options::SceneOptions with_boxes(options::SceneOptions options, const std::vector<geom::Box<2>>& boxes, double dx)
{
  options.pd.patches = boxes;
  options.pd.spacing = {dx};
  return options;
}

/// Of all strains at once.
double error_of(const options::SceneOptions& options)
{
  return test::worst_error(options, std::span(test::kStrains).last(1));
}

options::SceneOptions plate() { return test::held_plate({kCells, kCells}); }
} // namespace

// Lattice cells that straddle two elements: elements of 2.5 spacings.
TEST(PatchShapes, UniformStrainIsExactInAnyShape)
{
  for (const Shape& shape : kShapes)
    EXPECT_LE(error_of(with_boxes(plate(), shape.boxes, kElement / 2.5)), kExact) << shape.name;
}

TEST(PatchShapes, UniformStrainIsExactWithElementsOfOneAndTwoSpacings)
{
  for (const Shape& shape : {kShapes[0], kShapes[8]})
    for (const double spacings : {1.0, 2.0})
      EXPECT_LE(error_of(with_boxes(plate(), shape.boxes, kElement / spacings)), kExact) << shape.name << spacings;
}

TEST(PatchShapes, UniformStrainIsExactWithOtherBonds)
{
  for (const double ratio : {3.0, 5.0}) {
    auto options = with_boxes(plate(), kShapes[0].boxes, kElement / 2.0);
    options.pd.horizon_ratio = ratio;
    options.pd.micromodulus = law::Micromodulus::uniform;
    EXPECT_LE(error_of(options), kExact) << ratio;
  }
}

TEST(PatchShapes, TwoBoxesThatShareAnEdgeAreTheBoxTheyMakeUp)
{
  const double dx = kElement / 2.5;
  test::Scene one(with_boxes(plate(), {box(4, 4, 12, 12)}, dx)),
      two(with_boxes(plate(), {box(4, 4, 8, 12), box(8, 4, 12, 12)}, dx));
  ASSERT_EQ(two.plan().shapes.size(), 1u);
  EXPECT_EQ(two.sum(static_cast<double>(two.d().bonds->bonds())), one.sum(static_cast<double>(one.d().bonds->bonds())));
  EXPECT_EQ(two.sum(static_cast<double>(two.d().carried->bonds())),
            one.sum(static_cast<double>(one.d().carried->bonds())));
  const test::Field field = test::noise(7);
  EXPECT_DOUBLE_EQ(two.energy(two.blocks(field)), one.energy(one.blocks(field)));
}

// A box in which an L is left out: what is particles in both has the same bonds, by the same names.
TEST(PatchShapes, ABondKeepsItsNameWhateverIsActive)
{
  const double dx = kElement / 2.0;
  const test::Scene whole(with_boxes(plate(), {box(2, 2, 14, 14)}, dx)),
      part(with_boxes(plate(), kShapes[0].boxes, dx)),
      apart(with_boxes(plate(), {box(1, 1, 3, 3), box(6, 4, 9, 9)}, dx));
  const auto name = [](const couple::PatchShape& shape, const Vector<2>& x) {
    const Vector<2> at = (x - shape.lattice.origin) / shape.lattice.dx;
    return shape.names.of({static_cast<Index>(std::floor(at[0])), static_cast<Index>(std::floor(at[1]))});
  };
  for (const Vector<2>& x : {Vector<2>(0.26, 0.26), Vector<2>(0.4, 0.7), Vector<2>(0.9, 0.01)}) {
    const std::uint64_t expected = name(whole.plan().shapes[0], x);
    EXPECT_EQ(name(part.plan().shapes[0], x), expected);
    for (const couple::PatchShape& shape : apart.plan().shapes) EXPECT_EQ(name(shape, x), expected);
  }
}

TEST(PatchShapes, LatticesOfOtherSpacingOrPhaseNumberApart)
{
  auto options = with_boxes(plate(), {box(1, 1, 3, 3), box(6, 4, 8, 8)}, kElement / 2.0);
  options.pd.spacing = {kElement / 2.0, kElement / 2.5};
  const test::Scene scene(options);
  const auto& shapes = scene.plan().shapes;
  EXPECT_EQ(shapes[0].names.lattices, 2);
  EXPECT_NE(shapes[0].names.lattice, shapes[1].names.lattice);
}

TEST(PatchShapes, AnLAtAFreeSideIsExactInTensionAlongIt)
{
  for (const double spacings : {1.0, 2.5}) {
    EXPECT_LE(tension_error(with_boxes(bar(false), {box(4, 0, 12, 8), box(4, 8, 8, 12)}, kElement / spacings)), kExact)
        << spacings;
    EXPECT_LE(tension_error(with_boxes(bar(true), {box(4, 0, 8, 16), box(8, 0, 12, 8)}, kElement / spacings)), kExact)
        << spacings;
  }
}

TEST(PatchShapes, ExplicitStepsFeelTheSameForces)
{
  for (const Shape& shape : {kShapes[0], kShapes[4], kShapes[7]}) {
    test::Scene scene(with_boxes(plate(), shape.boxes, kElement / 2.0));
    const std::vector<double> u = scene.blocks(test::noise(5)), expected = scene.internal_force(u);
    scene.d().bonds->step_explicitly({});
    const std::vector<double> force = scene.internal_force(u);
    double largest = 0.0, difference = 0.0;
    for (std::size_t k = 0; k < force.size(); ++k) {
      largest = std::max(largest, std::abs(expected[k]));
      difference = std::max(difference, std::abs(force[k] - expected[k]));
    }
    EXPECT_GT(scene.max(largest), 0.0);
    EXPECT_LE(difference, 1e-12 * scene.max(largest)) << shape.name;
  }
}

// The way to a state that depends on everything: the same on one rank and on all.
TEST(PatchShapes, EnergyAndForcesAreThoseOfOneRank)
{
  const test::Field field = test::noise(3);
  for (const Shape& shape : std::span(kShapes).first(3)) {
    const auto options = with_boxes(plate(), shape.boxes, kElement / 2.5);
    const auto energy = [&](MPI_Comm comm) {
      const test::Scene scene(options, false, comm);
      return scene.energy(scene.blocks(field));
    };
    const auto work = [&](MPI_Comm comm) { // of the forces over another field
      test::Scene scene(options, false, comm);
      const std::vector<double> force = scene.internal_force(scene.blocks(field)), other = scene.blocks(test::noise(9));
      double sum = 0.0;
      for (std::size_t k = 0; k < force.size(); ++k) sum += force[k] * other[k];
      return scene.sum(sum);
    };
    EXPECT_NEAR(energy(PETSC_COMM_WORLD) / test::on_one_rank(energy), 1.0, 1e-12) << shape.name;
    EXPECT_NEAR(work(PETSC_COMM_WORLD) / test::on_one_rank(work), 1.0, 1e-9) << shape.name;
  }
}
} // namespace pdx::test::patch_shapes
