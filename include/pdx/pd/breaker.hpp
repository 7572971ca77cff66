#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/geom/site_set.hpp"
#include "pdx/law/regions.hpp"
#include "pdx/pd/bond_kernel.hpp"
#include "pdx/pd/stencil.hpp"

namespace pdx::pd {
/// The bond words of a window to write to; layout as BondView::words. Nothing here ever sets a bit: bonds do not heal.
using BondWords = std::array<std::uint64_t*, 2>;

/// When a bond breaks.
struct BreakRule {
  Kinematics kinematics = Kinematics::finite;
  double critical_stretch = 0.0;         ///< s0; bonds with s > s0 break             [-]
  const std::uint8_t* no_fail = nullptr; ///< per window site; bonds with an end where it is not 0 never break
  const law::Regions* regions = nullptr; ///< not null: s0 times `Regions::stretch` of the regions of both ends
  const std::uint8_t* region = nullptr;  ///< per window site, where there are regions
  const double* shares = nullptr;        ///< not null: s0 times 1 + those of both ends, per window site     [-]
  double least_share = 1.0;              ///< what this is at least                                          [-]
};

/// Bonds that broke, each counted by one rank only: sums over ranks are those of the scene.
struct Broken {
  std::int64_t bonds = 0;
  double energy = 0.0; ///< their strain energy at that moment, 1/2 kappa s^2 |xi| with the surface factor [J]
  Broken& operator+=(const Broken& other)
  {
    bonds += other.bonds;
    energy += other.energy;
    return *this;
  }
};

/// Where the sites of a window are. Points are those of the whole lattice, so that they are equal on every rank.
template <int Dim> struct WindowSites {
  geom::Lattice<Dim> lattice;                 ///< the whole patch
  Site<Dim> lower{};                          ///< site of window index 0
  Site<Dim> extent{};                         ///< sites per direction, padding included
  const geom::SiteSet<Dim>* active = nullptr; ///< sites of the patch; null: the whole lattice

  geom::SiteSet<Dim> sites() const { return active ? *active : geom::SiteSet<Dim>(lattice); }
};

/// Intact bonds that start at (whose lower end is) a particle of the runs. Summed over ranks: each bond once.
template <int Dim> std::int64_t count_bonds(const BondView<Dim>& view, std::span<const Run> runs);

/// Clears the bits of all bonds of the particles in the runs with s > s0 at view.u, and returns how many of those start
/// at a particle of the runs. A pass of its own: bonds are judged at one displacement, in any order. Bonds to particles
/// of other ranks are cleared here and there, by the same arithmetic to the last bit. Run kinds are not looked at;
/// afterwards runs of particles that lost a bond are no longer `whole`.
/// @param words the words of the view, writable
template <int Dim>
std::int64_t break_bonds(const BondView<Dim>& view, std::span<const Run> runs, const BreakRule& rule, BondWords words);

/// Clears the bits of all bonds in the window that a crack parts, and returns how many of those start at a particle of
/// the runs. In 3-D the cracks reach through the thickness.
template <int Dim>
std::int64_t cut_bonds(const crack::CrackSet& cracks, const WindowSites<Dim>& sites, const Stencil<Dim>& stencil,
                       std::span<const Run> runs, BondWords words);
} // namespace pdx::pd
