#include "cut_body.hpp"

#include "pdx/base/symmetric.hpp"
#include "pdx/fem/stress_recovery.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>
#include <random>

using namespace pdx;
using law::Kinematics;
using test::CutBody;
using test::CutBodyOptions;
using test::JumpField;
using xfem::Side;

namespace {
const std::vector<crack::Polyline> kSlanted{{{0.0, 0.13}, {1.0, 0.91}}};
constexpr std::array kBoth{Kinematics::small, Kinematics::finite};

CutBodyOptions cut_plate(std::vector<crack::Polyline> cracks, Kinematics kinematics = Kinematics::small,
                         double zigzag = 0.0)
{
  CutBodyOptions options;
  options.cracks = std::move(cracks);
  options.kinematics = kinematics;
  if (zigzag > 0.0) options.grid.moved = test::zigzag(options.grid.box, options.grid.cells, zigzag);
  return options;
}

/// Either half turned and shifted on its own.
JumpField rigid(Kinematics kinematics)
{
  return [kinematics](const Vector<2>& x, Side side) -> Vector<2> {
    const double turn = side == Side::plus ? 0.3 : -0.2;
    const Vector<2> shift = xfem::step(side) * Vector<2>(0.1, -0.2), across(-x.y(), x.x());
    if (kinematics == Kinematics::small) return shift + turn * across;
    return shift + std::cos(turn) * x + std::sin(turn) * across - x;
  };
}

/// Smooth on either side, with an opening; strains of a few per cent.
Vector<2> wavy(const Vector<2>& x, Side side)
{
  const double phase = 2.0 * x.x() + 3.0 * x.y() + xfem::step(side);
  return {0.03 * std::sin(phase) + 0.01 * xfem::step(side), 0.02 * std::cos(1.3 * phase)};
}

/// Numbers without a pattern at all rows, the same on any number of ranks.
std::vector<double> scattered(const CutBody& body, std::uint64_t seed)
{
  const test::Field noise = test::noise(seed);
  std::vector<double> blocks(static_cast<std::size_t>(2 * body.rows.owned()), 0.0);
  for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
    const auto put = [&](PetscInt row, const Vector<2>& value) {
      if (row < 0) return;
      blocks[static_cast<std::size_t>(2 * (row - body.rows.first))] = value.x();
      blocks[static_cast<std::size_t>(2 * (row - body.rows.first) + 1)] = value.y();
    };
    const Vector<2>& x = body.mesh.point(v);
    put(body.node_rows[static_cast<std::size_t>(v)], noise(x));
    for (const auto& set : body.sets.of(v)) put(set.row, noise(x + Vector<2>(2.0 + set.crack, 1.0)));
  }
  return blocks;
}
} // namespace

TEST(EnrichedTerm, HalvesOfACutPlateMoveRigidlyWithoutForce)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0.05, 0.95);
  std::vector<std::vector<crack::Polyline>> cracks{kSlanted,
                                                   {{{0.0, 0.5}, {1.0, 0.5}}},
                                                   {{{0.5, 1.0}, {0.5, 0.0}}},
                                                   {{{0.0, 0.0}, {1.0, 1.0}}},
                                                   {{{0.0, 0.31}, {0.45, 0.35}, {0.71, 1.0}}}};
  for (int k = 0; k < 30; ++k) cracks.push_back({{{0.0, place(random)}, {1.0, place(random)}}});
  for (std::size_t k = 0; k < cracks.size(); ++k)
    for (const Kinematics kinematics : kBoth) {
      const CutBody body(cut_plate(cracks[k], kinematics));
      const auto force = body.internal_force(body.owned_blocks(rigid(kinematics)));
      const auto typical = body.internal_force(body.owned_blocks(wavy)); // strains of a few per cent
      EXPECT_GT(body.norm(typical), 1e-3);
      EXPECT_LT(body.norm(force), 1e-12 * body.norm(typical)) << "crack " << k;
    }
}

// The stress of either half is without shear and pull across y = 0.58, so that the crack needs no force; what is left
// are tractions on the sides x = 0 and x = 1.
TEST(EnrichedTerm, ConstantStrainOnEitherSideHasForceAtTheRimOfTheHalvesOnly)
{
  const std::array<double, 2> strain{0.01, -0.02}; // minus, plus
  for (const bool distorted : {false, true}) {     // the cut cell's quadrature is exact for parallelograms only
    const double least = distorted ? 2e-8 : 1e-15;
    const CutBody body(cut_plate({{{0.0, 0.58}, {1.0, 0.58}}}, Kinematics::small, distorted ? 0.15 : 0.0));
    const double nu = body.options.law.poisson;
    const auto pulled = [&](const Vector<2>& x, Side side) -> Vector<2> {
      const double e = strain[static_cast<std::size_t>(side)];
      return {e * x.x(), -nu * e * x.y() + 0.03 * xfem::step(side)};
    };
    auto force = body.internal_force(body.owned_blocks(pulled));
    double right = 0.0;
    for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
      const Vector<2>& x = body.mesh.point(v);
      if (x.x() > 1e-9 && x.x() < 1.0 - 1e-9) continue;
      const auto at = [&](PetscInt row) { return static_cast<std::size_t>(2 * (row - body.rows.first)); };
      double& node = force[at(body.node_rows[static_cast<std::size_t>(v)])];
      if (x.x() > 0.5) right += node;
      node = 0.0;
      for (const auto& set : body.sets.of(v)) force[at(set.row)] = 0.0;
    }
    EXPECT_LT(body.norm(force), least);                                     // all but the x components at the sides
    const double pull = 10.0 * 0.2 * (0.58 * strain[0] + 0.42 * strain[1]); // E t e over either part of the side
    EXPECT_NEAR(body.sum(right), pull, least);
    const double exact = 0.5 * 10.0 * 0.2 * (0.58 * strain[0] * strain[0] + 0.42 * strain[1] * strain[1]);
    EXPECT_NEAR(body.energy(body.owned_blocks(pulled)), exact, least);
  }
}

TEST(EnrichedTerm, NodalStressIsThatOfTheNodesOwnSide)
{
  const CutBody body(cut_plate({{{0.0, 0.58}, {1.0, 0.58}}}));
  const double nu = body.options.law.poisson;
  const auto pulled = [&](const Vector<2>& x, Side side) -> Vector<2> {
    const double e = side == Side::plus ? -0.02 : 0.01;
    return {e * x.x(), -nu * e * x.y() + 0.03 * xfem::step(side)};
  };
  std::vector<double> displacement;
  for (const Vector<2>& x : body.mesh.points()) {
    const Vector<2> u = pulled(x, x.y() > 0.58 ? Side::plus : Side::minus);
    displacement.insert(displacement.end(), {u.x(), u.y()});
  }
  const auto stress = fem::nodal_stress({body.mesh, body.options.law, Kinematics::small}, displacement);
  for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
    const auto at = static_cast<std::size_t>(3 * v);
    EXPECT_NEAR(stress[at], 10.0 * (body.mesh.point(v).y() > 0.58 ? -0.02 : 0.01), 1e-13);
    EXPECT_NEAR(stress[at + 1], 0.0, 1e-13);
  }
}

TEST(EnrichedTerm, ForcesOfAnyOpeningSumToZero)
{
  for (const Kinematics kinematics : kBoth) {
    const CutBody body(cut_plate({{{0.0, 0.25}, {1.0, 0.25}}, {{1.0, 0.45}, {0.3, 0.42}}}, kinematics, 0.1));
    std::vector<double> u = scattered(body, 4);
    for (double& x : u) x *= 0.01;
    const auto force = body.internal_force(u);
    Vector<2> sum = Vector<2>::Zero();
    for (PetscInt k = 0; k < 2 * body.rows.nodes; ++k) sum[k % 2] += force[static_cast<std::size_t>(k)];
    EXPECT_GT(body.norm(force), 1e-2);
    for (int a = 0; a < 2; ++a) EXPECT_NEAR(body.sum(sum[a]), 0.0, 1e-14 * body.norm(force));
  }
}

TEST(EnrichedTerm, TangentTimesStepIsTheChangeOfTheForce)
{
  for (const Kinematics kinematics : kBoth) {
    CutBody body(cut_plate({{{0.0, 0.25}, {1.0, 0.25}}, {{1.0, 0.45}, {0.3, 0.42}}}, kinematics, 0.1));
    std::vector<double> u = scattered(body, 4);
    const std::vector<double> direction = scattered(body, 5);
    for (double& x : u) x *= 0.01;
    const double step = 1e-6;
    std::vector<double> up = u, down = u;
    for (std::size_t i = 0; i < u.size(); ++i) {
      up[i] += step * direction[i];
      down[i] -= step * direction[i];
    }
    const auto after = body.internal_force(up), before = body.internal_force(down);
    const MatHandle k = body.tangent(u);
    VecHandle d = body.rows.vector(), y = body.rows.vector();
    double* values = nullptr;
    PDX_CALL(VecGetArray(d.get(), &values));
    std::ranges::copy(direction, values);
    PDX_CALL(VecRestoreArray(d.get(), &values));
    PDX_CALL(MatMult(k.get(), d.get(), y.get()));
    const double* found = nullptr;
    PDX_CALL(VecGetArrayRead(y.get(), &found));
    std::vector<double> error(u.size()), size(found, found + u.size());
    for (std::size_t i = 0; i < u.size(); ++i) error[i] = found[i] - (after[i] - before[i]) / (2.0 * step);
    PDX_CALL(VecRestoreArrayRead(y.get(), &found));
    EXPECT_GT(body.norm(size), 1.0);
    EXPECT_LT(body.norm(error), 1e-8 * body.norm(size));
    PetscBool symmetric = PETSC_FALSE;
    PDX_CALL(MatIsSymmetric(k.get(), 1e-13, &symmetric));
    EXPECT_EQ(symmetric, PETSC_TRUE);
  }
}

TEST(EnrichedTerm, ForceAndEnergyAreThoseOfOneRank)
{
  for (const Kinematics kinematics : kBoth) {
    const auto options = cut_plate({{{0.0, 0.25}, {1.0, 0.25}}, {{1.0, 0.45}, {0.3, 0.42}}}, kinematics, 0.1);
    const auto deformed = [](const CutBody& body) {
      std::vector<double> u = scattered(body, 4);
      for (double& x : u) x *= 0.01;
      return u;
    };
    const CutBody body(options);
    const double energy = body.energy(deformed(body)), force = body.norm(body.internal_force(deformed(body)));
    const double energy_alone = test::on_one_rank([&](MPI_Comm comm) {
      const CutBody alone(options, comm);
      return alone.energy(deformed(alone));
    });
    const double force_alone = test::on_one_rank([&](MPI_Comm comm) {
      const CutBody alone(options, comm);
      return alone.norm(alone.internal_force(deformed(alone)));
    });
    EXPECT_GT(energy, 1e-4);
    EXPECT_NEAR(energy, energy_alone, 1e-13 * energy);
    EXPECT_NEAR(force, force_alone, 1e-13 * force);
  }
}

// Nodes between two cracks in neighbouring rows have a set for each. Sheets move rigidly, each on its own.
TEST(EnrichedTerm, ThreeSheetsBetweenTwoCracksMoveRigidlyWithoutForce)
{
  for (const double second : {0.45, 0.75}) { // in the row next to the first crack's, and two rows on
    const CutBody body(cut_plate({{{0.0, 0.25}, {1.0, 0.25}}, {{1.0, second}, {0.0, second}}}));
    const std::array<double, 3> turn{0.3, -0.1, 0.2};
    const auto moved = [&](const Vector<2>& x, int sheet) -> Vector<2> {
      return turn[static_cast<std::size_t>(sheet)] * Vector<2>(-x.y(), x.x()) + Vector<2>(0.1 * sheet, 0.2);
    };
    std::vector<double> u(static_cast<std::size_t>(2 * body.rows.owned()));
    const auto put = [&](PetscInt row, const Vector<2>& value) {
      u[static_cast<std::size_t>(2 * (row - body.rows.first))] = value.x();
      u[static_cast<std::size_t>(2 * (row - body.rows.first) + 1)] = value.y();
    };
    int twice = 0;
    for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
      const Vector<2>& x = body.mesh.point(v);
      const int sheet = (x.y() > 0.25) + (x.y() > second);
      put(body.node_rows[static_cast<std::size_t>(v)], moved(x, sheet));
      for (const auto& set : body.sets.of(v)) {
        const int other = set.crack == 0 ? (x.y() > 0.25 ? 0 : 1) : (x.y() > second ? 1 : 2);
        const Side there = xfem::opposite(set.side);
        put(set.row, (moved(x, other) - moved(x, sheet)) / xfem::shifted_step(there, set.side));
      }
      twice += body.sets.of(v).size() == 2;
    }
    EXPECT_EQ(body.sum(twice), second == 0.45 ? 7 : 0);
    EXPECT_LT(body.norm(body.internal_force(u)), 1e-13);
    EXPECT_GT(body.norm(u), 1.0);
  }
}

TEST(EnrichedTerm, OnlyRigidMotionsOfTheTwoHalvesAreFree)
{
  // Two halves: as many motions without force as the tangent has zero eigenvalues. On a few unknowns, densely.
  CutBodyOptions options = cut_plate(kSlanted);
  options.grid.cells = {4, 4};
  const int rigid_modes = static_cast<int>(test::on_one_rank([&](MPI_Comm comm) {
    CutBody body(options, comm);
    const PetscInt n = 2 * body.rows.owned();
    const MatHandle k = body.tangent(std::vector<double>(static_cast<std::size_t>(n), 0.0));
    Eigen::MatrixXd dense(n, n);
    for (PetscInt i = 0; i < n; ++i)
      for (PetscInt j = 0; j < n; ++j) PDX_CALL(MatGetValue(k.get(), i, j, &dense(i, j)));
    const Eigen::VectorXd modes = symmetric_eigenvalues(dense);
    return static_cast<double>((modes.array() < 1e-12 * modes.maxCoeff()).count());
  }));
  EXPECT_EQ(rigid_modes, 6);
}

TEST(EnrichedTerm, CouplingsCountEachNeighbourOnce)
{
  const CutBody body(cut_plate({{{0.0, 0.58}, {1.0, 0.58}}})); // a row of cells: 2 x 7 nodes with a set each
  field::Couplings couplings(*body.halo);
  body.terms[1]->couplings(couplings, true);
  for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
    const Vector<2>& x = body.mesh.point(v);
    const bool end = x.x() < 1e-9 || x.x() > 1.0 - 1e-9, in_row = !body.sets.of(v).empty();
    const auto count = [&](PetscInt row) {
      const auto at = static_cast<std::size_t>(row - body.rows.first);
      return couplings.diagonal[at] + couplings.off_diagonal[at];
    };
    const PetscInt expected = !in_row ? 1 : end ? 8 : 12; // nodes and sets of two or three columns, itself included
    EXPECT_EQ(count(body.node_rows[static_cast<std::size_t>(v)]), expected) << x.transpose();
    for (const auto& set : body.sets.of(v)) EXPECT_EQ(count(set.row), expected) << x.transpose();
  }
}
