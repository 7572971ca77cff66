#pragma once
#include "pdx/couple/schemes.hpp"
#include "pdx/couple/space_shape.hpp"

namespace pdx::couple {
/// Where material counts to bond families: where the body has some, and beyond its ends where points are all that
/// particles within `reach` sites see of them.
pd::Exists<3> family_of(const SpaceShape& shape, Index reach);
/// How far bonds of particles look along an end of the body: to their other ends, and whether these see a straight
/// side.
Index family_sight(const pd::Stencil<3>& stencil);

/// The carried bonds of all bodies that touch a row of this rank, by the scheme `energy`. Collective.
/// @param nodes of each shape
std::unique_ptr<CarriedBonds<3>> carry_bonds(const field::Rows& rows, const CouplingOptions& options,
                                             std::span<const std::unique_ptr<pd::LatticePart<3>>> parts,
                                             std::span<const SpaceShape> shapes, std::span<const NodeRows> nodes);

/// As of the plane.
///@{
std::optional<pd::LatticePart<3>::BondAt> lattice_bond(std::uint64_t key, const geom::SpaceNames& names,
                                                       const pd::Stencil<3>& stencil);
BondName bond_name(std::uint64_t key, const geom::SpaceNames& names, const pd::Stencil<3>& stencil);
///@}
} // namespace pdx::couple
