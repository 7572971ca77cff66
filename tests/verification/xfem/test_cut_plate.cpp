#include "pdx/base/symmetric.hpp"
#include "support/cracked.hpp"

#include <gtest/gtest.h>

namespace pdx::test {
namespace {
options::SceneOptions cut_plate(const crack::Polyline& line, std::array<Index, 2> cells = {9, 7})
{
  options::SceneOptions options = held_plate(cells);
  options.cracks.lines = {line};
  return options;
}

/// Uniaxial stress along the crack leaves its faces free, whatever its size on either side.
Field stretched_along(double angle, double strain, const Vector<2>& shift)
{
  const Vector<2> t(std::cos(angle), std::sin(angle)), n(-t.y(), t.x());
  const Tensor<2> gradient = strain * (t * t.transpose() - 1.0 / 3.0 * n * n.transpose()); // nu = 1/3
  return [gradient, shift](const Vector<2>& x) -> Vector<2> { return gradient * x + shift; };
}

struct Cut {
  Vector<2> point;
  double angle;
};

std::vector<Cut> random_cuts(std::size_t count)
{
  std::mt19937 random(20261122);
  std::uniform_real_distribution<double> place(0.1, 0.9), angle(0.0, 3.14159265358979);
  std::vector<Cut> cuts;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = place(random), y = place(random);
    cuts.push_back({{x, y}, angle(random)});
  }
  return cuts;
}

double largest(Scene& scene, std::span<const double> values)
{
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return scene.max(most);
}

TEST(CutPlate, HalvesMoveRigidlyWithoutForceAtTwoHundredRandomCuts)
{
  for (const Cut& cut : random_cuts(200)) {
    Scene scene(cut_plate(through_crack(cut.point, cut.angle)));
    const std::vector<double> u = sided_blocks(scene, {rigid(0.3, -0.2, 0.5), rigid(-0.1, 0.4, -0.7)});
    const double stiffness = plane_stress().young * plane_stress().thickness; // force of a strain of 1 over the body
    EXPECT_LT(largest(scene, scene.internal_force(u)), 1e-10 * stiffness)
        << cut.point.transpose() << " at " << cut.angle;
  }
}

TEST(CutPlate, ConstantStrainOnEitherSideIsExact)
{
  const Option tight("-ksp_rtol", "1e-12");
  int tested = 0;
  for (const Cut& cut : random_cuts(40)) {
    Scene scene(cut_plate(through_crack(cut.point, cut.angle)), true);
    const SidedField field{stretched_along(cut.angle, 0.01, {0.02, 0.03}),
                           stretched_along(cut.angle, -0.02, {0.0, 0.01})};
    prescribe_sided(scene, field);
    const VecHandle u = scene.solve();
    const bool moved = scene.d().sets->report().dropped > 0; // a sliver went to the other side
    tested += !moved;
    EXPECT_LT(sided_error(scene, u.get(), field), moved ? 1e-3 : 1e-9) << cut.point.transpose() << " at " << cut.angle;
  }
  EXPECT_GE(tested, 25); // a slanted cut has such a sliver in one case out of four
}

TEST(CutPlate, GridQuadratureMovesHalvesRigidlyToo)
{
  for (const Cut& cut : random_cuts(10)) {
    options::SceneOptions options = cut_plate(through_crack(cut.point, cut.angle));
    options.cracks.rule.quadrature = xfem::Quadrature::grid;
    Scene scene(options);
    const std::vector<double> u = sided_blocks(scene, {rigid(0.3, -0.2, 0.5), rigid(-0.1, 0.4, -0.7)});
    EXPECT_LT(largest(scene, scene.internal_force(u)), 1e-10 * 1.5);
  }
}

/// A crack that comes nearer and nearer to a node, at a slant, through a patch or not: never more iterations.
TEST(CutPlate, IterationsStayBoundedAsTheCrackNearsANode)
{
  const double h = 1.0 / 8.0;
  std::vector<int> iterations;
  for (int power = 1; power <= 14; ++power) {
    const Vector<2> near(0.5, 0.5 + h * std::pow(10.0, -power));
    Scene scene(cut_plate(through_crack(near, 0.3), {8, 8}), true);
    const SidedField field{rigid(0.3, -0.2, 0.5), rigid(-0.1, 0.4, -0.7)};
    prescribe_sided(scene, field);
    const VecHandle u = scene.solve();
    EXPECT_LT(sided_error(scene, u.get(), field), 1e-8);
    iterations.push_back(scene.report().linear_iterations);
  }
  EXPECT_LT(*std::max_element(iterations.begin(), iterations.end()), 60);
}

/// Largest over smallest eigenvalue of the assembled matrix, as it is and with its rows and columns scaled to a
/// diagonal of ones.
struct Condition {
  double raw, scaled;
};

double condition(const Eigen::MatrixXd& matrix)
{
  const Eigen::VectorXd values = symmetric_eigenvalues(matrix);
  EXPECT_GT(values[0], 0.0);
  return values[values.size() - 1] / values[0];
}

Condition condition_of(Scene& scene)
{
  solve::TangentOperator tangent(scene.system(), true);
  tangent.update(scene.blocks(affine(0.0, 0.0, 0.0, 0.0)));
  std::vector<Index> free; // rows of held components are no equations
  for (Index k = 0; k < 2 * scene.rows().owned(); ++k)
    if (!scene.system().held[static_cast<std::size_t>(k)]) free.push_back(k);
  const auto size = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd k(size, size);
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = 0; j < size; ++j) {
      const Index row = free[static_cast<std::size_t>(i)], column = free[static_cast<std::size_t>(j)];
      PDX_CALL(MatGetValue(tangent.matrix(), row, column, &k(i, j)));
    }
  const Eigen::VectorXd scale = k.diagonal().cwiseSqrt().cwiseInverse();
  return {condition(k), condition(scale.asDiagonal() * k * scale.asDiagonal())};
}

/// Away from nodes an enriched row is as stiff as a node's; rows of a side with little support are softer, down to the
/// share below which they are dropped.
TEST(CutPlate, ConditionStaysBoundedAsTheCrackNearsANode)
{
  const double h = 1.0 / 6.0;
  for (const bool patch : {false, true}) {
    const Vector<2> node = patch ? Vector<2>(1.0 / 3.0, 0.5) : Vector<2>(0.5, 0.5); // on the border of the patch
    for (const double angle : {0.0, 0.3, 0.78539816339744831})
      for (int power = 1; power <= 14; ++power) {
        const Vector<2> near = node + Vector<2>(0.0, h * std::pow(10.0, -power));
        options::SceneOptions options = cut_plate(through_crack(near, angle), {6, 6});
        if (patch) options = with_patch(options, {{1.0 / 3.0, 1.0 / 3.0}, {2.0 / 3.0, 2.0 / 3.0}}, h / 4.0);
        Scene scene(options, true, PETSC_COMM_SELF);
        const Condition found = condition_of(scene);
        EXPECT_LT(found.scaled, patch ? 200.0 : 50.0) << "at 1e-" << power << " h, angle " << angle;
        EXPECT_LT(found.raw, 1e7) << "at 1e-" << power << " h, angle " << angle;
      }
  }
}

options::SceneOptions cut_patch(const Cut& cut, couple::Scheme scheme, double dx)
{
  options::SceneOptions options = cut_plate(through_crack(cut.point, cut.angle), {10, 10});
  options.scheme = scheme;
  return with_patch(options, {{0.3, 0.3}, {0.7, 0.7}}, dx);
}

TEST(CutPatch, HalvesMoveRigidlyWithoutForceWhereTheCrackRunsThroughAPatch)
{
  for (const couple::Scheme scheme : {couple::Scheme::energy, couple::Scheme::ghost, couple::Scheme::interface})
    for (const double dx : {0.05, 0.02}) // whole numbers of spacings per element
      for (const Cut& cut : random_cuts(30)) {
        Scene scene(cut_patch(cut, scheme, dx));
        const std::vector<double> u = sided_blocks(scene, {rigid(0.3, -0.2, 0.5), rigid(-0.1, 0.4, -0.7)});
        EXPECT_LT(largest(scene, scene.internal_force(u)), 1e-10 * 1.5)
            << cut.point.transpose() << " at " << cut.angle << " dx " << dx << " scheme " << static_cast<int>(scheme);
      }
}

TEST(CutPatch, HalvesMoveRigidlyWithBrokenRatios)
{
  for (const Cut& cut : random_cuts(30)) {
    Scene scene(cut_patch(cut, couple::Scheme::energy, 0.04)); // 2.5 per element
    const std::vector<double> u = sided_blocks(scene, {rigid(0.3, -0.2, 0.5), rigid(-0.1, 0.4, -0.7)});
    EXPECT_LT(largest(scene, scene.internal_force(u)), 1e-10 * 1.5) << cut.point.transpose() << " at " << cut.angle;
  }
}

TEST(CutPatch, SolvesToRigidHalvesMatrixFreeInFewIterations)
{
  const Option tight("-ksp_rtol", "1e-12");
  for (const Cut& cut : {Cut{{0.5, 0.5}, 0.0}, Cut{{0.5, 0.52}, 0.4}, Cut{{0.48, 0.5}, 1.2}}) {
    Scene scene(cut_patch(cut, couple::Scheme::energy, 0.02));
    const SidedField field{rigid(0.3, -0.2, 0.5), rigid(-0.1, 0.4, -0.7)};
    prescribe_sided(scene, field);
    const VecHandle u = scene.solve();
    EXPECT_LT(sided_error(scene, u.get(), field), 1e-8);
    EXPECT_LE(scene.report().linear_iterations, 40) << cut.angle;
  }
}
} // namespace
} // namespace pdx::test
