#include "pdx/post/energy_ledger.hpp"
#include "support/ranks.hpp"

#include <gtest/gtest.h>

using namespace pdx;

using pdx::test::ranks;

namespace {
/// Every rank: one row; x is prescribed and hangs on a spring of 2 N/m, y carries a load of 4 N.
field::System two_springs()
{
  field::System system;
  system.rows = field::Rows::number(PETSC_COMM_WORLD, 2, 1, 0, 0);
  system.prescribed = {{0}, {3.0}};
  system.load = {1.0, 4.0}; // what loads a held component goes into its holder
  return system;
}

} // namespace

TEST(EnergyLedger, AddsTheWorkOfReactionsAndLoadsByHand)
{
  const field::System system = two_springs();
  post::EnergyLedger ledger(system);
  // step 1: x = 1 under 2 N, y = 0.5 under 2 N; the internal force at y is off by what a solver leaves
  const double u1[] = {1.0, 0.5}, f1[] = {2.0, 2.001}, u2[] = {3.0, 1.0}, f2[] = {6.0, 4.0};
  ledger.accept(0.5, u1, f1, {0.5, 0.25, 0.75, 0.0});
  EXPECT_NEAR(ledger.balance().work, ranks() * (0.5 * 2.0 * 1.0 + 0.5 * 2.0 * 0.5), 1e-14);
  EXPECT_NEAR(ledger.balance().error(), 0.0, 1e-14);
  ledger.accept(1.0, u2, f2, {3.0, 4.0, 2.0, 1.5});
  EXPECT_NEAR(ledger.balance().work, ranks() * (1.5 + 0.5 * (2.0 + 6.0) * 2.0 + 0.5 * (2.0 + 4.0) * 0.5), 1e-13);
  EXPECT_NEAR(ledger.balance().energies.elastic(), ranks() * 9.0, 1e-14);
  EXPECT_NEAR(ledger.balance().energies.dissipated, ranks() * 1.5, 1e-14);
  EXPECT_NEAR(ledger.balance().error(), ranks() * (11.0 - 9.0 - 1.5), 1e-13);
}

TEST(EnergyLedger, WorksBothWays)
{
  const field::System system = two_springs();
  post::EnergyLedger ledger(system);
  const double out[] = {1.0, 0.5}, force[] = {2.0, 2.0}, rest[] = {0.0, 0.0};
  ledger.accept(0.5, out, force, {1.0, 0.5, 0.0, 0.0});
  ledger.accept(0.0, rest, rest, {});
  EXPECT_NEAR(ledger.balance().work, 0.0, 1e-14);
  EXPECT_NEAR(ledger.balance().error(), 0.0, 1e-14);
}
