#include "pdx/base/events.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "support/elastic_problem.hpp"
#include "support/gmsh_grid.hpp"

#include <algorithm>
#include <gtest/gtest.h>

using namespace pdx;
using law::Kinematics;

namespace {
const law::Elastic kLaw{10.0, 0.3, law::Plane::stress, 0.2};
const geom::Box<2> kBox{{0.0, 0.0}, {1.2, 1.0}};
constexpr std::array<Index, 2> kCells{6, 5};

mesh::Mesh distorted() { return test::grid_mesh(PETSC_COMM_WORLD, {kBox, kCells, test::zigzag(kBox, kCells, 0.2)}); }
mesh::Mesh uniform() { return test::grid_mesh(PETSC_COMM_WORLD, {kBox, kCells, {}}); }

/// A smooth displacement with strains of a few per cent, the same on any number of ranks.
double wavy(const Vector<2>& x, int axis) { return 0.03 * std::sin(2.0 * x.x() + 3.0 * x.y() + axis); }
void deform(test::ElasticProblem& problem, const std::function<double(const Vector<2>&, int)>& u)
{
  problem.prescribe([&](const Vector<2>& x, int axis) { return std::optional(u(x, axis)); });
}
} // namespace

TEST(ElasticTerm, ForcesOfAnyDeformationSumToZero)
{
  const mesh::Mesh mesh = distorted();
  for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite}) {
    test::ElasticProblem problem(mesh, kLaw, kinematics);
    deform(problem, wavy);
    const auto force = problem.internal_force();
    double sum[2] = {0.0, 0.0}, size = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) sum[i % 2] += force[i], size += std::abs(force[i]);
    size = test::sum_all(PETSC_COMM_WORLD, size);
    EXPECT_GT(size, 0.01);
    for (const double s : sum) EXPECT_NEAR(test::sum_all(PETSC_COMM_WORLD, s), 0.0, 1e-14 * size);
  }
}

TEST(ElasticTerm, EnergyOfAUniformStrainCountsEveryCellOnce)
{
  const mesh::Mesh mesh = distorted();
  test::ElasticProblem problem(mesh, kLaw, Kinematics::small);
  deform(problem, [](const Vector<2>& x, int axis) { return axis == 0 ? 0.01 * x.x() : 0.0; });
  // 1/2 C11 e^2 t A with C11 = 10 / 0.91, t = 0.2, A = 1.2
  const double expected = 0.5 * 10.0 / 0.91 * 1e-4 * 0.2 * 1.2;
  const double energy = test::sum_all(PETSC_COMM_WORLD, problem.term().energy(problem.local_displacement()));
  EXPECT_NEAR(energy, expected, 1e-13 * expected);
}

TEST(ElasticTerm, EnergyCountsCellsAllOfWhoseNodesAreOnOtherRanks)
{
  Index lonely = 0;
  for (const Index n : {3, 4, 5}) { // strips and small squares cut into three leave such cells
    for (const std::array<Index, 2> cells : {std::array{n, Index{1}}, std::array{Index{1}, n}, std::array{n, n}}) {
      const mesh::Mesh mesh = test::grid_mesh(PETSC_COMM_WORLD, {{{0.0, 0.0}, {1.0, 1.0}}, cells, {}});
      for (Index c = 0; c < mesh.owned_cells(); ++c)
        lonely += std::ranges::all_of(mesh.cell(c), [&](Index v) { return v >= mesh.owned_vertices(); });
      test::ElasticProblem problem(mesh, kLaw, Kinematics::small);
      deform(problem, [](const Vector<2>& x, int axis) { return axis == 0 ? 0.01 * x.x() : 0.0; });
      const double expected = 0.5 * 10.0 / 0.91 * 1e-4 * 0.2;
      const double energy = test::sum_all(PETSC_COMM_WORLD, problem.term().energy(problem.local_displacement()));
      EXPECT_NEAR(energy, expected, 1e-13 * expected) << cells[0] << " x " << cells[1] << " cells";
    }
  }
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const double all_lonely = test::sum_all(PETSC_COMM_WORLD, lonely);
  if (ranks == 3) {
    EXPECT_GT(all_lonely, 0.0);
  }
}

TEST(ElasticTerm, TangentTimesStepIsTheChangeOfTheForce)
{
  const mesh::Mesh mesh = distorted();
  for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite}) {
    test::ElasticProblem problem(mesh, kLaw, kinematics);
    const double step = 1e-6;
    const auto direction = [](const Vector<2>& x, int axis) {
      return std::cos(5.0 * x.x() - 2.0 * x.y() + 2.0 * axis);
    };
    deform(problem, [&](const Vector<2>& x, int a) { return wavy(x, a) + step * direction(x, a); });
    const auto after = problem.internal_force();
    deform(problem, [&](const Vector<2>& x, int a) { return wavy(x, a) - step * direction(x, a); });
    const auto before = problem.internal_force();
    deform(problem, wavy);
    const MatHandle held = problem.tangent(); // all prescribed: nothing but the diagonal is left
    problem.release();
    const MatHandle k = problem.tangent();
    VecHandle d = problem.rows().vector(), y = problem.rows().vector();
    double* values = nullptr;
    PDX_CALL(VecGetArray(d.get(), &values));
    for (Index v = 0; v < mesh.owned_vertices(); ++v)
      for (int a = 0; a < 2; ++a) values[2 * v + a] = direction(mesh.point(v), a);
    PDX_CALL(VecRestoreArray(d.get(), &values));
    PDX_CALL(MatMult(k.get(), d.get(), y.get()));
    const double* found = nullptr;
    PDX_CALL(VecGetArrayRead(y.get(), &found));
    for (std::size_t i = 0; i < after.size(); ++i) EXPECT_NEAR(found[i], (after[i] - before[i]) / (2.0 * step), 2e-8);
    PDX_CALL(VecRestoreArrayRead(y.get(), &found));
    PetscReal norm = 0.0;
    PDX_CALL(MatNorm(k.get(), NORM_INFINITY, &norm));
    EXPECT_GT(norm, 1.0);
    PDX_CALL(MatMult(held.get(), d.get(), y.get()));
    PDX_CALL(VecAXPY(y.get(), -kLaw.young * kLaw.thickness, d.get()));
    PDX_CALL(VecNorm(y.get(), NORM_INFINITY, &norm));
    EXPECT_EQ(norm, 0.0);
  }
}

TEST(ElasticTerm, CouplingsAreExact)
{
  const mesh::Mesh mesh = uniform();
  test::ElasticProblem problem(mesh, kLaw, Kinematics::small);
  field::Couplings couplings(problem.halo());
  problem.term().couplings(couplings, true);
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    const auto row = static_cast<std::size_t>(problem.node_rows()[static_cast<std::size_t>(v)] - problem.rows().first);
    const Vector<2>& x = mesh.point(v);
    const bool on_x = std::min(x.x(), 1.2 - x.x()) < 1e-9, on_y = std::min(x.y(), 1.0 - x.y()) < 1e-9;
    // A node of a grid meets 3 x 3 nodes, itself included; a line of them is missing at a side.
    EXPECT_EQ(couplings.diagonal[row] + couplings.off_diagonal[row], (on_x ? 2 : 3) * (on_y ? 2 : 3));
  }
}

TEST(ElasticTerm, CoveredCellsCarryNothing)
{
  mesh::Mesh mesh = uniform();
  for (Index c = 0; c < mesh.cells(); ++c)
    if (mesh.centroid(c).x() > 0.6) mesh.cover(c, 0);
  test::ElasticProblem problem(mesh, kLaw, Kinematics::small);
  EXPECT_EQ(problem.rows().total, 4 * 6); // the left half: 3 x 5 cells
  deform(problem, [](const Vector<2>& x, int axis) { return axis == 0 ? 0.01 * x.x() : 0.0; });
  const double expected = 0.5 * 10.0 / 0.91 * 1e-4 * 0.2 * 0.6;
  const double energy = test::sum_all(PETSC_COMM_WORLD, problem.term().energy(problem.local_displacement()));
  EXPECT_NEAR(energy, expected, 1e-13 * expected);
}

TEST(ElasticTerm, ARankWithoutCellsTakesPart)
{
  const mesh::Mesh mesh = test::grid_mesh(PETSC_COMM_WORLD, {{{0.0, 0.0}, {2.0, 1.0}}, {2, 1}, {}});
  test::ElasticProblem problem(mesh, kLaw, Kinematics::finite);
  fem::add_traction(mesh, *mesh.boundary("right"), {0.264 * kLaw.young, 0.0}, kLaw.thickness, problem.loads());
  problem.prescribe([](const Vector<2>& x, int axis) -> std::optional<double> {
    return (axis == 0 && x.x() < 1e-9) || x.norm() < 1e-9 ? std::optional(0.0) : std::nullopt;
  });
  EXPECT_GT(problem.solve(), 0);
  const auto u = problem.vertex_displacement();
  for (Index v = 0; v < mesh.owned_vertices(); ++v) // nominal stress E l (l^2 - 1) / 2 at stretch l = 1.2
    EXPECT_NEAR(u[2 * static_cast<std::size_t>(v)], 0.2 * mesh.point(v).x(), 1e-9);
}

TEST(ElasticTerm, ReportsItsEvents)
{
  const mesh::Mesh mesh = uniform();
  test::ElasticProblem problem(mesh, kLaw, Kinematics::small);
  const int before = event_counts()["fe_residual"].count;
  problem.internal_force();
  EXPECT_EQ(event_counts()["fe_residual"].count, before + 1);
  const int assembled = event_counts()["fe_jacobian"].count;
  problem.tangent();
  EXPECT_EQ(event_counts()["fe_jacobian"].count, assembled + 1);
}

TEST(ReusedStiffness, IntegratesOnceForAUniformMeshAndAgainForEveryOtherShape)
{
  const mesh::Mesh even = uniform(), odd = distorted();
  for (const auto& [mesh, expected] : {std::pair{&even, std::min(1, even.cells())}, std::pair{&odd, odd.cells()}}) {
    fem::ReusedStiffness reused(kLaw);
    for (Index c = 0; c < mesh->cells(); ++c) {
      const auto& k = reused.of(mesh->corners(c));
      const auto own = fem::element_tangent(mesh->corners(c), fem::ElementVector::Zero(), kLaw, Kinematics::small);
      EXPECT_LT((k - own).norm(), 1e-12 * own.norm());
    }
    EXPECT_EQ(reused.integrations(), expected);
  }
}
