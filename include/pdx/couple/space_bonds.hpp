#pragma once
#include "pdx/couple/schemes.hpp"
#include "pdx/geom/space_names.hpp"
#include "pdx/mpm/body.hpp"
#include "pdx/mpm/grid_cell.hpp"

#include <map>

namespace pdx::couple {
/// Where particles have taken cells of a body of material points in space: all of them are one patch, of any shape, on
/// the lattice of the body's points.
struct SpaceShape {
  const mpm::Body<3>* of = nullptr; ///< outlives this
  Index body = 0;                   ///< its number
  geom::ActiveLattice<3> where;     ///< sites are counted from the body's corner
  geom::SpaceNames names;
  double face_share = 0.0; ///< `couple::face_share`

  /// Is a material point on a site?
  bool has_point(const Site<3>& site) const { return !where.active.has(site) && of->has(site); }
};

/// Global rows of the nodes of a grid where points meet particles, of all ranks, by place.
using NodeRows = std::map<Site<3>, PetscInt>;

/// Where material counts to bond families: where the body has some, and beyond its ends where points are all that
/// particles within `reach` sites see of them.
pd::Exists<3> family_of(const SpaceShape& shape, Index reach);

/// What carries a place in which a bond leaves the particles: the nodes of the face of points there, as they carry
/// points, and by `face_bubble`. Bonds that cross faces of grid cells then hand any uniform strain on as a uniform
/// traction: each lattice cell is crossed alike by what its mirror images are. Empty where `beyond`, the lattice cell
/// that the bond goes on in, has no points.
/// @param x in spacings from the body's corner
std::optional<Host> face_host(const SpaceShape& shape, const NodeRows& rows, const Vector<3>& x, const Site<3>& beyond);

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
