#pragma once
#include "pdx/track/bond_graph.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace pdx::track {
/// A box of whole lattice cells, counted from the lattice's origin; all that follows is in spacings.
struct CellBox {
  Vector<2> lower, upper; ///< whole numbers
  Vector<2> size() const { return upper - lower; }
  double edge() const { return size().minCoeff(); } ///< the shorter one
  bool holds(const Vector<2>& x) const              ///< or its border does
  {
    return (x.array() >= lower.array()).all() && (x.array() <= upper.array()).all();
  }
  Vector<2> corner(int k) const { return {k & 1 ? upper[0] : lower[0], k & 2 ? upper[1] : lower[1]}; }
};

inline Vector<2> in_spacings(const geom::Lattice<2>& lattice, const Vector<2>& x)
{
  return (x - lattice.origin) / lattice.dx;
}
inline Vector<2> in_metres(const geom::Lattice<2>& lattice, const Vector<2>& x)
{
  return lattice.origin + lattice.dx * x;
}
inline CellBox in_spacings(const geom::Lattice<2>& lattice, const geom::Box<2>& box)
{
  return {in_spacings(lattice, box.lower).array().round(), in_spacings(lattice, box.upper).array().round()};
}
inline geom::Box<2> in_metres(const geom::Lattice<2>& lattice, const CellBox& box)
{
  return {in_metres(lattice, box.lower), in_metres(lattice, box.upper)};
}
inline Vector<2> middle_of(const Site<2>& site) { return {site[0] + 0.5, site[1] + 0.5}; }

inline double cross(const Vector<2>& a, const Vector<2>& b) { return a[0] * b[1] - a[1] * b[0]; }
inline Vector<2> left_of(const Vector<2>& direction) { return {-direction[1], direction[0]}; }
/// Goes from 1 to 0 between `begin` and `end`, so that nothing hangs on rounding.
inline double fade(double x, double begin, double end) { return std::clamp((end - x) / (end - begin), 0.0, 1.0); }

/// A straight line with a sense, in spacings.
struct Line {
  Vector<2> at, along;                                                     ///< unit vector
  double offset(const Vector<2>& x) const { return cross(along, x - at); } ///< positive on its left
};
} // namespace pdx::track
