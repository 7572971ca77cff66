#pragma once
#include "pdx/pd/breaker.hpp"
#include "pdx/pd/side_weights.hpp"
#include "pdx/pd/solid_sides.hpp"

#include <functional>

namespace pdx::pd {
/// True for a site, inside or outside the lattice, where the body has material that counts to a bond family.
template <int Dim> using Exists = std::function<bool(const Site<Dim>&)>;

/// The factors that free surfaces, and regions of other materials, give to the stiffness of the bonds which start in a
/// window.
template <int Dim> struct BondFactors {
  /// False where all bonds that start at the site have the factor 1.
  std::function<bool(const Site<Dim>& lower)> any;
  /// x after the sites along x, from this one on, that have none of `any`.
  std::function<Index(const Site<Dim>& lower)> end_of_plain;
  /// Of the bond along a half arm from its lower end, which must be in the window; the bond must be there.     [-]
  std::function<double(const Site<Dim>& lower, std::size_t arm)> of;
  /// The part of it that is due to surfaces, where materials differ besides; empty: all of it.                 [-]
  std::function<double(const Site<Dim>& lower, std::size_t arm)> surface;
  /// Rows beside a straight free side in which tension along it is as uniform all in all, force and moment; 0: none.
  Index even_over = 0;
};
/// How bonds of a lattice are corrected at free surfaces: looks at a window and says its factors, the same for a bond
/// in whatever window. Empty: not at all.
template <int Dim> using SurfaceCorrection = std::function<BondFactors<Dim>(const WindowSites<Dim>&)>;

/// Largest step of a family member in any direction, bonds or not: the width of a complete neighbourhood in sites.
template <int Dim> int family_reach(const Stencil<Dim>& stencil);
/// Family volume of a site over that of a complete family [-]; 1 inside, less near a free surface.
template <int Dim> double family_share(const Stencil<Dim>& stencil, const Site<Dim>& site, const Exists<Dim>& exists);

/// The papers' volume method: 2 / (q_i + q_j), q = `family_share`.
template <int Dim> SurfaceCorrection<Dim> correct_volumes(Stencil<Dim> stencil, Exists<Dim> exists);

/// `SideWeights`, in space `SolidSides`, beside each straight side along rows: of the body, where no site exists
/// behind, and of the cracks, both of whose faces are sides. Where sides meet, the product of theirs. A side is
/// straight at a site whose neighbours up to a reach away along it, as far as they hang together, are as many rows
/// inside: sides at a slant, re-entrant corners and the last rows behind a tip are left as they are.
/// @param cracks must outlive the result; may be nullptr
///@{
SurfaceCorrection<2> correct_sides(Stencil<2> stencil, SideWeights weights, Exists<2> exists,
                                   const crack::CrackSet* cracks);
SurfaceCorrection<3> correct_sides(Stencil<3> stencil, SolidSides weights, Exists<3> exists,
                                   const crack::CrackSet* cracks);
///@}
} // namespace pdx::pd
