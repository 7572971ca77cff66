#pragma once
#include "pdx/base/processor.hpp"
#include "pdx/pd/breaker.hpp"

#include <vector>

namespace pdx::pd {
/// Bonds of particles that lie anywhere, as neighbour lists: bonds first[i] .. first[i + 1] are those of particle i,
/// each bond in the lists of both its ends.
template <int Dim> struct CsrView {
  std::span<const std::int64_t> first;     ///< one entry per owned particle and one more
  const std::int32_t* neighbour = nullptr; ///< per bond: local row of j
  const std::uint8_t* intact = nullptr;    ///< per bond: 1, or 0 once it broke
  const double* length = nullptr;          ///< per bond: |xi|                                   [m]
  const double* weight = nullptr;          ///< per bond: kappa / |xi|                           [N/m]
  const double* points = nullptr;          ///< reference position, rows of Dim, halo included   [m]
};

/// What a pass over the bonds saw.
struct CsrSeen {
  bool overstretched = false; ///< an intact bond has s > critical stretch, to 1e-12
  double energy = 0.0;        ///< half of each bond's energy, 1/2 kappa s^2 |xi| / 2, if asked for [J]
};

/// r_i += internal force -sum_j kappa s n, as `add_force` of bond_kernel.hpp; bond by bond.
/// @param u displacement, rows of Dim, halo included   @param r rows of Dim
template <int Dim>
CsrSeen add_csr_force(const CsrView<Dim>& view, Kinematics kinematics, double critical_stretch, const double* u,
                      double* r, bool energy = false);

/// The same, several bonds of a particle at once: neighbours are gathered into lanes.
template <int Dim>
CsrSeen add_gathered_force(Processor processor, const CsrView<Dim>& view, Kinematics kinematics,
                           double critical_stretch, const double* u, double* r, bool energy = false);

/// Clears `intact` where s > rule.critical_stretch at u, by the expressions of breaker.hpp; each end judges alike.
/// rule.no_fail is per local row. @param intact that of the view   @return the numbers of the bonds cleared
template <int Dim>
std::vector<std::int64_t> break_csr_bonds(const CsrView<Dim>& view, const BreakRule& rule, const double* u,
                                          std::uint8_t* intact);
} // namespace pdx::pd
