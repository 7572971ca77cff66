#pragma once
#include "pdx/base/tensor.hpp"

#include <cstdint>

namespace pdx::geom {
/// Numbers of the sites of a lattice that spans the whole body and a margin around it, of which a patch shows a piece.
/// They are the same whatever patch shows them, and whatever is active. All lattices of a body number apart.
struct SiteNames {
  std::array<std::int64_t, 2> first{}; ///< the piece's site (0, 0) in the lattice of the body
  std::int64_t width = 1;              ///< sites per row of that
  std::int64_t lattice = 0, lattices = 1;

  std::uint64_t of(const Site<2>& site) const
  {
    return static_cast<std::uint64_t>(((first[1] + site[1]) * width + first[0] + site[0]) * lattices + lattice);
  }
};
} // namespace pdx::geom
