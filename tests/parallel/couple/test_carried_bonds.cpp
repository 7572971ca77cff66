#include "pdx/couple/carried_bonds.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using couple::CarriedBond;

namespace {
/// Per rank one row, a particle at x = rank; from the first row on, springs from each row's particle to the next one's
/// (the last one's to the first), all of reference length 2 m along x, and held by both ranks they touch.
struct Ring {
  int rank = 0, ranks = 1;
  field::Rows rows;
  std::unique_ptr<field::RowHalo> halo;
  std::unique_ptr<couple::CarriedBonds<2>> bonds;

  /// @param change edits the two springs that start at row 0, of stiffness 3 and 5
  explicit Ring(const std::function<void(CarriedBond<2>&, CarriedBond<2>&)>& change = [](auto&, auto&) {})
  {
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
    rows = field::Rows::number(PETSC_COMM_WORLD, 2, 0, 0, 1 + (rank == 0));
    const PetscInt last = rows.total - 1; // on another rank than row 0 where there are several
    couple::CarriedPoints<2> points;
    std::vector<CarriedBond<2>> list;
    if (rank == 0 || rank == ranks - 1) {
      const Index a = points.add(couple::Host::of_row(0));
      const Index b = points.add(couple::Host::of_row(last));
      CarriedBond<2> first{a, b, a, b, {2.0, 0.0}, 3.0, 0.0, 0.25}, second{a, b, a, b, {2.0, 0.0}, 5.0, 0.0, 0.5};
      change(first, second);
      list = {first, second};
    }
    bonds = std::make_unique<couple::CarriedBonds<2>>(rows, std::move(points), std::move(list), law::Kinematics::small,
                                                      true);
    std::vector<PetscInt> needed;
    bonds->needed_rows(needed);
    halo = std::make_unique<field::RowHalo>(rows, needed);
    bonds->bind(*halo);
  }

  /// Row 0 at rest, all others moved by `by` along x.
  std::vector<double> moved(double by) const
  {
    std::vector<double> owned, all;
    for (Index row = 0; row < rows.owned(); ++row) owned.insert(owned.end(), {rows.first + row ? by : 0.0, 0.0});
    halo->fetch(owned, 2, all);
    return all;
  }
  double sum(double mine) const
  {
    MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    return mine;
  }
  /// Force on row 0 along x at s = 0.1 [N], told to all.
  double pull() const
  {
    std::vector<double> r(static_cast<std::size_t>(2 * rows.owned()), 0.0);
    bonds->add_residual(moved(0.2), r);
    double total = 0.0;
    for (std::size_t k = 0; k < r.size(); k += 2) total += r[k];
    EXPECT_NEAR(sum(total), 0.0, 1e-15);
    return -sum(rank == 0 ? r[0] : 0.0);
  }
  pd::Broken break_at(double stretch, const std::vector<double>& critical)
  {
    std::vector<pd::BreakRule> rules;
    for (const double s0 : critical) rules.push_back({law::Kinematics::small, s0, nullptr});
    std::vector<double> ratios;
    bonds->overstretched(moved(2.0 * stretch), rules, ratios);
    const pd::Broken mine = bonds->break_bonds(moved(2.0 * stretch), rules);
    EXPECT_EQ(static_cast<std::int64_t>(ratios.size()), mine.bonds);
    return {static_cast<std::int64_t>(sum(static_cast<double>(mine.bonds))), sum(mine.energy)};
  }
  pd::BondedVolume volume() const
  {
    std::vector<pd::BondedVolume> volumes(static_cast<std::size_t>(rows.owned()));
    bonds->add_bonded_volume(volumes);
    const pd::BondedVolume first = rank == 0 ? volumes[0] : pd::BondedVolume{};
    return {sum(first.whole), sum(first.start), sum(first.now)};
  }
};
} // namespace

TEST(CarriedBonds, BreakOnBothRanksAndCountOnce)
{
  Ring ring;
  EXPECT_NEAR(ring.pull(), 0.8, 1e-15);
  EXPECT_EQ(ring.break_at(0.1, {0.11}).bonds, 0);
  const pd::Broken broken = ring.break_at(0.1, {0.09});
  EXPECT_EQ(broken.bonds, 2);
  EXPECT_NEAR(broken.energy, 0.5 * (3.0 + 5.0) * 0.01 * 2.0, 1e-15);
  EXPECT_EQ(ring.pull(), 0.0);
  EXPECT_EQ(ring.sum(ring.bonds->energy(ring.moved(0.2))), 0.0);
  EXPECT_EQ(ring.break_at(0.2, {0.09}).bonds, 0);
  ring.bonds->restore(); // as constructed
  EXPECT_NEAR(ring.pull(), 0.8, 1e-15);
}

TEST(CarriedBonds, BreakByTheRuleOfTheirPatch)
{
  Ring ring([](auto&, auto& second) { second.patch = 1; });
  EXPECT_EQ(ring.break_at(0.1, {0.11, 0.09}).bonds, 1);
  EXPECT_NEAR(ring.pull(), 0.3, 1e-15);
}

TEST(CarriedBonds, WhatMustNotFailHolds)
{
  Ring ring([](auto& first, auto&) { first.no_fail = true; });
  EXPECT_EQ(ring.break_at(0.5, {0.09}).bonds, 1);
  EXPECT_NEAR(ring.pull(), 0.3, 1e-15);
}

TEST(CarriedBonds, CutFromTheStartTheyCarryNothingButCountInTheFamily)
{
  Ring ring([](auto& first, auto&) { first.cut = true; });
  EXPECT_NEAR(ring.pull(), 0.5, 1e-15);
  EXPECT_NEAR(ring.sum(ring.bonds->energy(ring.moved(0.2))), 0.5 * 5.0 * 0.01 * 2.0, 1e-15);
  EXPECT_EQ(ring.volume().whole, 0.75);
  EXPECT_EQ(ring.volume().start, 0.5);
  EXPECT_EQ(ring.volume().now, 0.5);
  EXPECT_EQ(ring.break_at(0.5, {0.09}).bonds, 1);
  EXPECT_EQ(ring.volume().start, 0.5);
  EXPECT_EQ(ring.volume().now, 0.0);
  ring.bonds->restore();
  EXPECT_NEAR(ring.pull(), 0.5, 1e-15);
}

TEST(CarriedBonds, TheTangentLosesWhatBreaks)
{
  Ring ring([](auto& first, auto&) { first.no_fail = true; });
  field::Couplings before(*ring.halo), after(*ring.halo);
  ring.bonds->couplings(before, true);
  ring.break_at(0.5, {0.09});
  ring.bonds->couplings(after, true);
  EXPECT_EQ(after.diagonal, before.diagonal);
  EXPECT_EQ(after.off_diagonal, before.off_diagonal);
  ring.bonds->linearise(ring.moved(0.2));
  MatHandle matrix;
  const PetscInt local = 2 * ring.rows.owned();
  PDX_CALL(MatCreateAIJ(ring.rows.comm, local, local, PETSC_DETERMINE, PETSC_DETERMINE, 4, nullptr, 4, nullptr,
                        matrix.out()));
  PDX_CALL(MatSetBlockSize(matrix.get(), 2));
  const std::vector<std::uint8_t> held(static_cast<std::size_t>(2 * ring.halo->size()), 0);
  field::BlockAdder adder(matrix.get(), *ring.halo, held);
  ring.bonds->add_jacobian(adder, true);
  adder.finish(1.0);
  VecHandle diagonal = ring.rows.vector();
  PDX_CALL(MatGetDiagonal(matrix.get(), diagonal.get()));
  double total = 0.0;
  PDX_CALL(VecSum(diagonal.get(), &total));
  EXPECT_NEAR(total, 2.0 * 3.0 / 2.0, 1e-15); // kappa / xi at either end
}
