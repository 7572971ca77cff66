#pragma once
#include "pdx/pd/bond_kernel.hpp"
#include "pdx/pd/stencil.hpp"

#include <vector>

namespace pdx::pd {
/// sum_i += sum_j mu beta V over both halves of the family: the volume that particle i is bonded to.       [m^3]
/// Bonds are those of view.words (run kinds are not looked at); `mute` family members have no bond and do not count.
/// @param sum one entry per row
template <int Dim>
void add_bonded_volume(const BondView<Dim>& view, const Stencil<Dim>& stencil, std::span<const Run> runs, double* sum);

/// Bonded volume of one particle at three times.                                          [m^3]
struct BondedVolume {
  double whole = 0.0; ///< before any crack
  double start = 0.0; ///< after the cracks it was given (the precrack), before anything broke
  double now = 0.0;
};

/// phi = 1 - sum mu beta V / sum beta V [XPD1 Eq. 9] of the bonds that broke under load, over the whole family; the
/// precrack's bonds count in `precrack_share` instead, and the two add up to Eq. 9 as printed. 0 for a particle that
/// never had a bond.                                                                       [-]
double damage(const BondedVolume& volume);
double precrack_share(const BondedVolume& volume);
} // namespace pdx::pd
