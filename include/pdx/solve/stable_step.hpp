#pragma once
#include "pdx/field/system.hpp"

#include <array>

namespace pdx::solve {
/// How long an explicit step may be at rest, and the row that says so.
struct StableStep {
  double limit = 0.0;            ///< 2 / omega for an omega that no frequency is above; infinite if nothing moves [s]
  PetscInt row = -1;             ///< global, -1 if nothing moves
  std::array<double, 3> place{}; ///< of that row, unused components 0 [m]
};

/// (step / 2)^2 of some owned rows, one range after the other, which no frequency that it alone bounds would exceed;
/// infinite where nothing is stiff, 0 where there is no mass [s^2].
std::vector<double> row_limits(field::System& system, field::RowRanges wanted);

/// The lumped mass of the owned rows, all Terms [kg].
std::vector<double> lumped_mass(const field::System& system);
/// Writes it down in the system, unless it is there.
void know_mass(field::System& system);
/// The same where that of some rows only is unknown: all others stand there already.
void know_mass(field::System& system, field::RowRanges unknown);
/// The ties of owned rows, all Terms.
std::vector<field::Tie> ties_of(const field::System& system);

/// From `Term::add_mass` and `add_stiffness_bound` of all Terms: min over rows of 2 sqrt(m_i / lambda_max(D_i)), over
/// free components; the same on any number of ranks. Of rows that decide alike, the lowest place counts.
/// Throws SolverFailure naming the place if a row that can move has stiffness but no mass. Collective.
StableStep stable_step(const field::System& system);
/// The same of what Terms were parted into as far; nothing else has stiffness.
StableStep far_stable_step(const field::System& system);
} // namespace pdx::solve
