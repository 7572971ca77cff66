#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/law/bond.hpp"

#include <vector>

namespace pdx::pd {
/// continuum: the constants of the continuous solid as they are. lattice: scaled per bond length so that the lattice
/// has exactly the solid's C11 and C12.
enum class Calibration { continuum, lattice };

/// What a stencil is made from. SI units.
struct StencilOptions {
  double dx = 0.0;        ///< lattice spacing                                          [m]
  double thickness = 1.0; ///< out of plane, equal to elastic.thickness; unused in 3-D   [m]
  double horizon = 0.0;   ///< delta                                                    [m]
  law::Micromodulus micromodulus = law::Micromodulus::conical;
  Calibration calibration = Calibration::lattice;
  law::Elastic elastic;
};

/// One neighbour direction of the lattice. Reference geometry and constants only.
template <int Dim> struct Arm {
  Site<Dim> step{};         ///< site of j minus site of i                              [-]
  Vector<Dim> xi;           ///< x_j - x_i                                              [m]
  double length = 0.0;      ///< |xi|                                                   [m]
  double kappa = 0.0;       ///< bond force per unit stretch, c(xi) beta gamma V V      [N]
  double volume_share = 0.; ///< beta, the part of V_j counted: clip((delta + dx/2 - xi)/dx, 0, 1)   [-]
};

/// The bonds of a full family. Bonds are those with a stiffness: with the conical micromodulus a neighbour at exactly
/// xi = delta belongs to the family (it has volume) but has no bond; such neighbours are in `mute`.
/// The family is xi <= delta (conical) or xi < delta + dx/2 (uniform; leaving the outer half cell out would make the
/// lattice 12-14 % too soft).
template <int Dim> struct Stencil {
  std::vector<Arm<Dim>>
      half; ///< every bond once: step[Dim-1] > 0, or == 0 and step[Dim-2] > 0, ...; the other is -step
  std::vector<Arm<Dim>> mute; ///< same half of the family members without stiffness; they count as volume only
  int reach = 0;              ///< largest |step| component of a bond (of `half`)         [-]
  double dx = 0.0;            ///< [m]
  double thickness = 0.0;     ///< [m]; 1 in 3-D
  double horizon = 0.0;       ///< delta                                                 [m]
  double density = 0.0;       ///< rho; 0: statics only                               [kg/m^3]

  /// Volume of one particle, dx^2 thickness or dx^3.                                    [m^3]
  double volume() const;
  /// Volume of a complete family, sum of beta V over both halves of `half` and `mute`.  [m^3]
  double family_volume_full() const;
};

/// Builds the stencil. Calibration::lattice: each shell k of equal bond length gets a weight gamma_k: the least
/// sum_k S_k (gamma_k - 1)^2, S_k the shell's share of the stiffness, with exact C11 and C12 (= C66).
/// Throws UserError for numbers that are not positive, a wrong Poisson's ratio, a horizon of more than 20 dx, and a
/// horizon that has no positive weights.
template <int Dim> Stencil<Dim> make_stencil(const StencilOptions& options);

/// Widest stencil the bond words hold: two words of 64 half arms.
inline constexpr int kMaxHalfArms = 128;
/// Throws UserError for a stencil that is too wide for the bond words: no particles can have it.
template <int Dim> void require_bond_words(const Stencil<Dim>& stencil);

/// Elastic constants of the lattice: c11 = 1/2 sum c beta V xi n_x^4, c12 = c66 = 1/2 sum c beta V xi n_x^2 n_y^2 over
/// a full family (gamma included).                                                         [Pa]
struct LatticeModuli {
  double c11 = 0.0, c12 = 0.0, c66 = 0.0;
};
template <int Dim> LatticeModuli lattice_moduli(const Stencil<Dim>& stencil);

/// The papers' critical step, sqrt(2 rho / sum c V / xi) over a full family, with the calibrated bonds [XPD1 Eq. 26].
/// In 2-D the bound of `BondTerm` is sqrt(2) times that, and the lattice's own limit is higher still.       [s]
template <int Dim> double papers_step(const Stencil<Dim>& stencil);

/// Energy to cut the lattice between two rows, all bonds stretched to s0: per area, sum over bonds upwards of
/// step_y 1/2 kappa s0^2 xi / (dx t).                                                  [J/m^2]
template <int Dim> double lattice_toughness(const Stencil<Dim>& stencil, double critical_stretch);
} // namespace pdx::pd
