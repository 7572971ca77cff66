#pragma once
#include "pdx/pd/stencil.hpp"

namespace pdx::pd {
/// Whose energy per crack area is Gc. lattice: that of the bonds as they are, a crack between two rows. continuum: that
/// of the continuous bond law [XPD1 Eqs. 6, 7]; the lattice's is then off by up to 10 %.
enum class Toughness { lattice, continuum };

/// Critical stretch s0 for the energy release rate Gc [J/m^2]. lattice: with it `lattice_toughness` is Gc, since that
/// goes with s0 squared.                                                                    [-]
/// Throws UserError if Gc is not positive and finite.
template <int Dim>
double critical_stretch(const Stencil<Dim>& stencil, const law::BondLaw<Dim>& bond, double toughness, Toughness by);
} // namespace pdx::pd
