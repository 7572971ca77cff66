#pragma once
#include "pdx/couple/leaving.hpp"

#include <span>
#include <utility>
#include <vector>

namespace pdx::couple {
/// A bond from a row to a point of a straight side.
template <int Dim> struct RunBond {
  std::size_t number = 0; ///< by which it is told afterwards
  Index row = 0;          ///< of its particle, local
  Index point = 0;        ///< of its other end, among the carried ones
  Index patch = 0;
  bool no_fail = false;
  double stretch = 1.0; ///< critical one over that of the patch [-]
  Vector<Dim> xi;       ///< from the particle to the point [m]
  Leaving leaves;
};

inline constexpr Index kRunTile = 64; ///< places of a side that are laid out together

/// A bond, and where it is laid out.
template <int Dim> struct PlacedBond {
  const RunBond<Dim>* bond;
  Index cell;           ///< of the lattice, in which it meets the side, counted from its particle's
  std::int64_t within;  ///< where in that cell it does, in millionths; the border of two is the beginning of the upper
  Index place;          ///< of its particle, counted on through all sides of the patch
  std::size_t kind = 0; ///< those of one kind are of one tile, and alike but for their places there

  std::pair<Index, Index> tile() const { return {bond->patch, place / kRunTile}; }
};

/// Tile after tile, in each kind after kind, in each by places, and those from one place as given.
template <int Dim> std::vector<PlacedBond<Dim>> in_order(std::span<const RunBond<Dim>> bonds);
} // namespace pdx::couple
