#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/law/kinematics.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace pdx::pd {
/// One half arm laid on a window: the bond from i to j = i + jump.
template <int Dim> struct HalfArm {
  std::ptrdiff_t jump = 0;      ///< window index of j minus that of i          [-]
  std::array<double, Dim> xi{}; ///< x_j - x_i in the reference                 [m]
  double length = 0.0;          ///< |xi|                                       [m]
  double kappa = 0.0;           ///< bond force per unit stretch                [N]
};

/// One rank's window of one patch: padded, dense, row-major, x fastest. All arrays share the window index.
/// Kernels work on 8 particles at a time and read (never write) up to 7 entries past the end of a run, and their
/// neighbours; the window has 16 readable entries past the last particle of every row and `reach` entries around.
/// A bond is one bit, kept at its lower end: the bond i -> i + jump_h is bit h of words[.][i], so the bond from i the
/// other way is bit h of words[.][i - jump_h]. A bit of a bond to a missing site is 0.
template <int Dim> struct BondView {
  std::array<const double*, Dim> u{};          ///< displacement per component, 0 on missing sites   [m]
  std::array<const std::uint64_t*, 2> words{}; ///< bit h % 64 of words[h / 64][i]: bond is there and intact
  const std::uint16_t* classes = nullptr;      ///< per site: which surface factors the bonds that start there have;
                                               ///< 0: all 1; nullptr: 0 everywhere
  const double* factors = nullptr;             ///< of class c and half arm h: entry c * arms + h             [-]
  std::span<const HalfArm<Dim>> arms;          ///< at most 128
  const double* swelling = nullptr;            ///< per site: half its free strain, so that the sum over both ends is
                                               ///< that of the bond; nullptr: 0 everywhere                 [-]
};

/// whole: all 2 * arms bonds of every particle of the run are there with surface factor 1; words and classes are
/// not looked at. partial: they are.
enum class RunKind { whole, partial };

/// Contiguous particles of one lattice row.
struct Run {
  std::ptrdiff_t at = 0; ///< window index of the first particle
  Index row = 0;         ///< local row of the first particle; the others follow
  Index length = 0;      ///< number of particles
  RunKind kind = RunKind::partial;
};

/// Forces, energies and breaking are of the stretch s beyond the bond's free strain.
using law::Kinematics;

// All kernels gather: a particle adds up its own 2 * arms bonds and writes its own row only, so runs go in any order.
// Rows are interleaved (row * Dim + d), the layout of a Vec. w is 1 for an intact bond times its surface factor, and 0
// for a missing one, which then contributes exactly 0 whatever finite entries the missing neighbour has.

/// y_i -= sum_j w K_ij u_j with K = kappa / |xi| n n^T [N/m]: the off-diagonal part of the linear tangent.     [N]
/// @param y rows of Dim
template <int Dim> void subtract_neighbours(const BondView<Dim>& view, std::span<const Run> runs, double* y);

/// d_i += sum_j w K_ij: the diagonal of the linear tangent.                                                   [N/m]
/// @param d rows of Dim x Dim
template <int Dim> void diagonal_blocks(const BondView<Dim>& view, std::span<const Run> runs, double* d);

/// r_i += internal force -sum_j w kappa s n [N]; n points along the deformed (finite) or reference (linear) bond.
/// finite: s = (2 xi.eta + eta.eta) / (|xi| (|xi + eta| + |xi|)), which does not cancel at small strain; a bond
/// squeezed to length 0 has no direction and gives NaN.
/// @param r rows of Dim
template <int Dim>
void add_force(const BondView<Dim>& view, std::span<const Run> runs, Kinematics kinematics, double* r);

/// y_i -= sum_j w k_ij x_j: the off-diagonal part of the exact tangent of the finite `add_force` at view.u, with
/// k = kappa (1/|xi| e e^T + s/|y| (I - e e^T)), y = xi + eta, e = y/|y|.                                       [N]
/// @param x window of the vector the tangent acts on   @param y rows of Dim
template <int Dim>
void subtract_neighbours_finite(const BondView<Dim>& view, std::type_identity_t<std::array<const double*, Dim>> x,
                                std::span<const Run> runs, double* y);

/// d_i += sum_j w k_ij: the diagonal of the exact tangent at view.u.                                           [N/m]
/// @param d rows of Dim x Dim
template <int Dim> void diagonal_blocks_finite(const BondView<Dim>& view, std::span<const Run> runs, double* d);

/// w_i += strain energy density sum_j 1/4 w kappa s^2 |xi| / volume: half of each bond's energy.  [XPD1 Eq. 30] [J/m^3]
/// @param volume of a particle [m^3]   @param density one entry per row
template <int Dim>
void add_energy_density(const BondView<Dim>& view, std::span<const Run> runs, Kinematics kinematics, double volume,
                        double* density);
} // namespace pdx::pd
