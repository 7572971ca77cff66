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

/// (step / 2)^2 of each owned row, which no frequency that it alone bounds would exceed; infinite where nothing is
/// stiff, 0 where there is no mass [s^2].
/// @param known local rows of which nothing is asked, [first, end) each, ascending: theirs are infinite
std::vector<double> row_limits(const field::System& system, std::span<const std::array<Index, 2>> known = {});

/// The lumped mass of the owned rows, all Terms [kg].
std::vector<double> lumped_mass(const field::System& system);
/// The ties of owned rows, all Terms.
std::vector<field::Tie> ties_of(const field::System& system);

/// From `Term::add_mass` and `add_stiffness_bound` of all Terms: min over rows of 2 sqrt(m_i / lambda_max(D_i)), over
/// free components; the same on any number of ranks. Of rows that decide alike, the lowest place counts.
/// Throws SolverFailure naming the place if a row that can move has stiffness but no mass. Collective.
StableStep stable_step(const field::System& system);
/// The same of what Terms were parted into as far; nothing else has stiffness.
StableStep far_stable_step(const field::System& system);
} // namespace pdx::solve
