#pragma once
#include <array>
#include <cstddef>

namespace pdx::xfem {
/// The two sides of a crack. A point on the crack itself, at distance 0, is on the plus side.
enum class Side { minus, plus };
inline constexpr std::array kSides{Side::minus, Side::plus};

/// Side of a point at a signed distance from the crack [m].
constexpr Side side_of(double distance) { return distance < 0.0 ? Side::minus : Side::plus; }
constexpr Side opposite(Side side) { return side == Side::plus ? Side::minus : Side::plus; }

/// H = 1 on the plus side, -1 on the minus side [XPD1 Eq. 11].
constexpr double step(Side side) { return side == Side::plus ? 1.0 : -1.0; }

/// H(x) - H(x_i): what an enriched unknown is multiplied by at a point x [XPD1 Eq. 12]. It is 0 on the node's own side,
/// so that elements the crack does not cut feel no enrichment, and +-2 across the crack: the unknown is half the
/// opening at the node.
constexpr double shifted_step(Side at, Side node) { return step(at) - step(node); }

/// Areas of something on either side of a crack [m^2].
struct SideAreas {
  std::array<double, 2> area{}; ///< minus, plus [m^2]

  constexpr double& operator[](Side side) { return area[static_cast<std::size_t>(side)]; }
  constexpr double operator[](Side side) const { return area[static_cast<std::size_t>(side)]; }
  constexpr double total() const { return area[0] + area[1]; }
  /// Part of the total that lies on a side, 0 to 1.                               [-]
  constexpr double share(Side side) const { return (*this)[side] / total(); }
};
} // namespace pdx::xfem
