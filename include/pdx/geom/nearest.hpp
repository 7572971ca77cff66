#pragma once
#include "pdx/base/tensor.hpp"

#include <algorithm>
#include <array>

namespace pdx::geom {
/// Weights of a and b, from 0 to 1 and with sum 1, of the point of the segment between them that is nearest to x.
/// Exactly 0 and 1 at its ends.
template <int Dim>
std::array<double, 2> nearest_on_segment(const Vector<Dim>& a, const Vector<Dim>& b, const Vector<Dim>& x)
{
  const Vector<Dim> along = b - a;
  const double length2 = along.squaredNorm(), to = along.dot(x - a);
  if (!(to > 0.0)) return {1.0, 0.0};
  if (!(to < length2)) return {0.0, 1.0};
  return {1.0 - to / length2, to / length2};
}

/// The same of a triangle.  [Ericson, Real-Time Collision Detection, 5.1.5]
inline std::array<double, 3> nearest_on_triangle(const Vector<3>& a, const Vector<3>& b, const Vector<3>& c,
                                                 const Vector<3>& x)
{
  const Vector<3> ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const double b_at_a = ab.dot(ax), c_at_a = ac.dot(ax);
  if (b_at_a <= 0.0 && c_at_a <= 0.0) return {1.0, 0.0, 0.0};
  const double b_at_b = ab.dot(bx), c_at_b = ac.dot(bx);
  if (b_at_b >= 0.0 && c_at_b <= b_at_b) return {0.0, 1.0, 0.0};
  const double of_c = b_at_a * c_at_b - b_at_b * c_at_a; // twice areas, times that of the triangle
  if (of_c <= 0.0 && b_at_a >= 0.0 && b_at_b <= 0.0) {
    const double to = b_at_a / (b_at_a - b_at_b);
    return {1.0 - to, to, 0.0};
  }
  const double b_at_c = ab.dot(cx), c_at_c = ac.dot(cx);
  if (c_at_c >= 0.0 && b_at_c <= c_at_c) return {0.0, 0.0, 1.0};
  const double of_b = b_at_c * c_at_a - b_at_a * c_at_c;
  if (of_b <= 0.0 && c_at_a >= 0.0 && c_at_c <= 0.0) {
    const double to = c_at_a / (c_at_a - c_at_c);
    return {1.0 - to, 0.0, to};
  }
  const double of_a = b_at_b * c_at_c - b_at_c * c_at_b;
  const double from_b = c_at_b - b_at_b, from_c = b_at_c - c_at_c;
  if (of_a <= 0.0 && from_b >= 0.0 && from_c >= 0.0) {
    const double to = from_b / (from_b + from_c);
    return {0.0, 1.0 - to, to};
  }
  const double all = of_a + of_b + of_c;
  return {1.0 - of_b / all - of_c / all, of_b / all, of_c / all};
}
} // namespace pdx::geom
