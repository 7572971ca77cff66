#pragma once
#include "pdx/base/tensor.hpp"

#include <cstdint>
#include <limits>
#include <optional>

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

  /// The site of a name as the piece counts it, none if it is of another lattice or too far away to be counted.
  std::optional<Site<2>> site(std::uint64_t name) const
  {
    const auto all = static_cast<std::uint64_t>(lattices), wide = static_cast<std::uint64_t>(width);
    if (name % all != static_cast<std::uint64_t>(lattice)) return std::nullopt;
    const std::int64_t at[2] = {static_cast<std::int64_t>(name / all % wide) - first[0],
                                static_cast<std::int64_t>(name / all / wide) - first[1]};
    for (const std::int64_t k : at)
      if (k < std::numeric_limits<Index>::min() || k > std::numeric_limits<Index>::max()) return std::nullopt;
    return Site<2>{static_cast<Index>(at[0]), static_cast<Index>(at[1])};
  }
};
} // namespace pdx::geom
