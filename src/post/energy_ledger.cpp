#include "pdx/post/energy_ledger.hpp"

namespace pdx::post {
EnergyLedger::EnergyLedger(const field::System& system)
    : system_(system), at_{std::vector<double>(system.load.size(), 0.0),
                           std::vector<double>(system.load.size(), 0.0),
                           {}}
{}

EnergyLedger::EnergyLedger(const field::System& system, LedgerState state, double load)
    : system_(system), at_(std::move(state))
{
  for (field::Support* support : system.supports) {
    support->go_to_load(load);
    support->note(at_.u);
  }
}

std::vector<double> external_force(const field::System& system, double load, std::span<const double> internal_force)
{
  std::vector<double> force(system.load);
  for (double& f : force) f *= load;
  for (const Index c : system.prescribed.components)
    force[static_cast<std::size_t>(c)] = internal_force[static_cast<std::size_t>(c)];
  return force;
}

const EnergyBalance& EnergyLedger::accept(double load, std::span<const double> u,
                                          std::span<const double> internal_force, const Energies& mine)
{
  std::vector<double> force = external_force(system_, load, internal_force);
  double work = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    work += 0.5 * (at_.force[i] + force[i]) * (u[i] - at_.u[i]);
    at_.u[i] = u[i];
  }
  at_.force = std::move(force);
  for (field::Support* support : system_.supports) {
    work += support->work_since(u);
    support->note(u);
  }
  double sums[] = {work,        mine.elements, mine.bonds,  mine.interface, mine.dissipated,
                   mine.points, mine.supports, mine.contact};
  MPI_Allreduce(MPI_IN_PLACE, sums, 8, MPI_DOUBLE, MPI_SUM, system_.rows.comm);
  at_.balance.work += sums[0];
  at_.balance.energies = {sums[1], sums[2], sums[3], sums[4]};
  at_.balance.energies.points = sums[5];
  at_.balance.energies.supports = sums[6];
  at_.balance.energies.contact = sums[7];
  return at_.balance;
}
} // namespace pdx::post
