#pragma once
#include "pdx/base/lanes.hpp"
#include "pdx/mpm/grid_rule.hpp"

/// Shape functions along an axis of the nodes that a point sees, the first `kFirst` behind its cell's number, and their
/// derivatives. Places in sides of a cell from the cell's number.
namespace pdx::mpm {
struct Hats {
  static constexpr int kReach = 2, kFirst = 0;
  explicit Hats(double) {}
  template <class T> PDX_INLINE void at(T x, T (&n)[2], T (&g)[2]) const
  {
    n[0] = 1.0 - x;
    n[1] = x;
    g[0] = T{} - 1.0;
    g[1] = T{} + 1.0;
  }
};

/// Hats meant over 2 l around the point [Bardenhagen and Kober, 2004], l of the reference.
struct MeantHats {
  static constexpr int kReach = 3, kFirst = -1;
  double l; ///< half of dx, in sides of a cell
  explicit MeantHats(double half) : l(half) {}
  template <class T> PDX_INLINE void at(T x, T (&n)[3], T (&g)[3]) const
  {
    T high = x + l, low = l - x;
    high = high > 0.0 ? high : T{};
    low = low > 0.0 ? low : T{};
    high = high < 2.0 * l ? high : T{} + 2.0 * l;
    low = low < 2.0 * l ? low : T{} + 2.0 * l;
    const T above = x - l, below = -l - x;
    n[2] = high * high * (0.25 / l) + (above > 0.0 ? above : T{});
    n[0] = low * low * (0.25 / l) + (below > 0.0 ? below : T{});
    n[1] = 1.0 - n[0] - n[2];
    g[2] = high * (0.5 / l);
    g[0] = low * (-0.5 / l);
    g[1] = -(g[0] + g[2]);
  }
};

struct Splines {
  static constexpr int kReach = 3, kFirst = -1;
  explicit Splines(double) {}
  template <class T> PDX_INLINE void at(T x, T (&n)[3], T (&g)[3]) const
  {
    const T low = 0.5 - x, high = 0.5 + x;
    n[0] = 0.5 * low * low;
    n[1] = 0.75 - x * x;
    n[2] = 0.5 * high * high;
    g[0] = -low;
    g[1] = -2.0 * x;
    g[2] = high;
  }
};
} // namespace pdx::mpm
