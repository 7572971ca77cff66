#pragma once
#include "pdx/base/tensor.hpp"

#include <cmath>

namespace pdx::geom {
/// A corner of a cell and a spacing, which stand for a whole lattice.
struct LatticeAnchor {
  Vector<2> corner;     ///< [m]
  double spacing = 0.0; ///< [m]
};

/// Do both stand for one lattice: spacings alike to 1e-6, lines to a thousandth of them?
inline bool same_lattice(const LatticeAnchor& a, const LatticeAnchor& b)
{
  const Eigen::Array2d lines = (b.corner - a.corner).array() / a.spacing;
  return std::abs(a.spacing - b.spacing) <= 1e-6 * a.spacing && ((lines - lines.round()).abs() < 1e-3).all();
}
} // namespace pdx::geom
