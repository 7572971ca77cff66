#pragma once
#include "pdx/geom/box.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace pdx::geom {
/// Part of a segment a + t (b - a): enter <= t <= leave, both in [0, 1].          [-]
struct Clip {
  double enter, leave;
};

/// The part of the segment a -> b inside the closed box (Liang-Barsky); nothing if it misses.
/// A segment that only touches the box has enter == leave.
template <int Dim> std::optional<Clip> clip(const Vector<Dim>& a, const Vector<Dim>& b, const Box<Dim>& box)
{
  Clip part{0.0, 1.0};
  for (int d = 0; d < Dim; ++d) {
    const double along = b[d] - a[d];
    if (along == 0.0) {
      if (a[d] < box.lower[d] || a[d] > box.upper[d]) return std::nullopt;
      continue;
    }
    double first = (box.lower[d] - a[d]) / along, last = (box.upper[d] - a[d]) / along;
    if (first > last) std::swap(first, last);
    part.enter = std::max(part.enter, first);
    part.leave = std::min(part.leave, last);
  }
  if (part.enter > part.leave) return std::nullopt;
  return part;
}
} // namespace pdx::geom
