#pragma once
#include "pdx/base/tensor.hpp"

namespace pdx::geom {
/// Axis-aligned box, closed.                                                   [m]
template <int Dim> struct Box {
  Vector<Dim> lower = Vector<Dim>::Zero();
  Vector<Dim> upper = Vector<Dim>::Zero();
  Vector<Dim> size() const { return upper - lower; }
  /// True if x lies in the box grown by `margin` on every side.
  bool contains(const Vector<Dim>& x, double margin = 0.0) const
  {
    return ((x - lower).array() >= -margin).all() && ((upper - x).array() >= -margin).all();
  }
};
} // namespace pdx::geom
