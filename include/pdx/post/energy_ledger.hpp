#pragma once
#include "pdx/field/system.hpp"

#include <utility>

namespace pdx::post {
/// Where the energy of a body is. [J]
struct Energies {
  double elements = 0.0, bonds = 0.0, interface = 0.0; ///< elastic: FE, lattice bonds, carried bonds
  double dissipated = 0.0;                             ///< by broken bonds so far
  double points = 0.0;                                 ///< elastic: material points
  double contact = 0.0;                                ///< between bodies that touch; elastic too
  double friction = 0.0;                               ///< taken by it so far
  double viscous = 0.0;                                ///< likewise, by damping
  double supports = 0.0;                               ///< of springs and pins outside the body; elastic too

  double elastic() const { return elements + bonds + interface + points + contact + supports; }
  double taken() const { return dissipated + friction + viscous; } ///< for good
};

/// The books after a step. [J]
struct EnergyBalance {
  double work = 0.0; ///< of the loads and of what is prescribed, since the start
  Energies energies; ///< of all ranks
  /// work - elastic - dissipated. In statics this is what the trapezoidal rule leaves and what a crack that jumps at a
  /// fixed load sets free beyond the energy of its bonds.
  double error() const { return work - energies.elastic() - energies.dissipated; }
};

/// What a ledger goes on from.
struct LedgerState {
  std::vector<double> u, force; ///< owned components, of the last accepted step [m, N]
  EnergyBalance balance;
};

/// The load, and the internal force where a displacement is prescribed (reaction and load together); 0 elsewhere [N].
std::vector<double> external_force(const field::System& system, double load, std::span<const double> internal_force);

/// Energy over the accepted steps of a load path that starts at rest without load.
class EnergyLedger {
public:
  /// The system, its loads and prescribed components complete, must outlive the ledger.
  explicit EnergyLedger(const field::System& system);
  /// Goes on from another, perhaps of another layout, accepted at a load; supports are left there.
  EnergyLedger(const field::System& system, LedgerState state, double load);

  /// Books an accepted equilibrium. External forces are the load, and the internal force where a displacement is
  /// prescribed (reaction and load together); their work is added by the trapezoidal rule, as is that of supports
  /// that move. Collective.
  /// @param load load factor   @param u, internal_force of the owned rows, 2-D or 3-D as the system [m, N]
  /// @param mine this rank's energies, totals at this step
  const EnergyBalance& accept(double load, std::span<const double> u, std::span<const double> internal_force,
                              const Energies& mine);
  const EnergyBalance& balance() const { return at_.balance; }
  const LedgerState& state() const { return at_; }

private:
  const field::System& system_;
  LedgerState at_;
};
} // namespace pdx::post
