#pragma once
#include "pdx/base/tensor.hpp"

#include <cstdint>
#include <optional>

namespace pdx::geom {
/// Numbers of the sites of a lattice that fills the box around a body in space and a margin; those of the next body go
/// on behind. As `SiteNames` of the plane, they are the same whatever is active.
struct SpaceNames {
  static constexpr Index kMargin = 24; ///< sites on each side: more than a bond reaches
  Site<3> count{};                     ///< of the box
  std::uint64_t first = 0;             ///< names of the bodies before

  std::uint64_t wide(std::size_t d) const { return static_cast<std::uint64_t>(count[d] + 2 * kMargin); }
  std::uint64_t size() const { return wide(0) * wide(1) * wide(2); }

  std::uint64_t of(const Site<3>& site) const
  {
    std::uint64_t number = 0;
    for (std::size_t d = 3; d-- > 0;) number = number * wide(d) + static_cast<std::uint64_t>(site[d] + kMargin);
    return first + number;
  }

  /// The site of a name, none if it is of another body.
  std::optional<Site<3>> site(std::uint64_t name) const
  {
    if (name < first || name - first >= size()) return std::nullopt;
    name -= first;
    Site<3> at{};
    for (std::size_t d = 0; d < 3; ++d) {
      at[d] = static_cast<Index>(name % wide(d)) - kMargin;
      name /= wide(d);
    }
    return at;
  }
};
} // namespace pdx::geom
