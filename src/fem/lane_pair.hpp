#pragma once
#include "pdx/base/lanes.hpp"

#include <numbers>

namespace pdx::fem {
/// A plane vector of numbers T, lanes of elements as a rule.
template <class T> struct Pair {
  T x, y;
};
template <class T> PDX_INLINE Pair<T> operator+(Pair<T> a, Pair<T> b) { return {a.x + b.x, a.y + b.y}; }
template <class T> PDX_INLINE Pair<T> operator-(Pair<T> a, Pair<T> b) { return {a.x - b.x, a.y - b.y}; }
template <class T> PDX_INLINE Pair<T> operator-(Pair<T> a) { return {-a.x, -a.y}; }
template <class S, class T> PDX_INLINE Pair<T> operator*(S s, Pair<T> b) { return {s * b.x, s * b.y}; }
template <class T> PDX_INLINE T dot(Pair<T> a, Pair<T> b) { return a.x * b.x + a.y * b.y; }

/// Weights of both ends of a line of the reference square at its Gauss points +-1/sqrt(3): (1 +- 1/sqrt(3)) / 2.
constexpr double kNear = 0.5 * (1.0 + std::numbers::inv_sqrt3), kFar = 0.5 * (1.0 - std::numbers::inv_sqrt3);

/// at[0] nearer to a, at[1] nearer to b. Equal ends give themselves, to the last bit.
template <class V> PDX_INLINE void to_points(V a, V b, V (&at)[2])
{
  const V part = kFar * (b - a);
  at[0] = a + part;
  at[1] = b - part;
}

/// Forces on the corners from those at the Gauss lines: along the first edges at[0], at[1], along the others across.
/// Corners counter-clockwise; `along` pulls corners 1, 2 and `across` corners 2, 3.
template <class V> PDX_INLINE void to_corners(const V (&along)[2], const V (&across)[2], V (&f)[4])
{
  const V low = kNear * along[0] + kFar * along[1], high = kFar * along[0] + kNear * along[1];
  const V left = kNear * across[0] + kFar * across[1], right = kFar * across[0] + kNear * across[1];
  f[0] = -(low + left);
  f[1] = low - right;
  f[2] = high + right;
  f[3] = left - high;
}
} // namespace pdx::fem
