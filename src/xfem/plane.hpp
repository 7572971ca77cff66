#pragma once
#include "pdx/geom/polygon.hpp"

namespace pdx::xfem {
inline double cross_product(const Vector<2>& a, const Vector<2>& b) { return a.x() * b.y() - a.y() * b.x(); }

inline Vector<2> middle_of(const geom::Polygon& outline)
{
  Vector<2> sum = Vector<2>::Zero();
  for (const Vector<2>& x : outline) sum += x;
  return sum / static_cast<double>(outline.size());
}
} // namespace pdx::xfem
