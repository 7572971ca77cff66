#pragma once
#include "pdx/base/lanes.hpp"

#include <algorithm>
#include <utility>

/// Blocks of Dim values of neighbouring rows as one vector per component, and back.
namespace pdx {
template <int W, int Dim> using NodeLanes = Lanes<W>[Dim];

namespace lines {
template <class V, std::size_t... L> PDX_INLINE void part(V a, V b, V (&to)[2], std::index_sequence<L...>)
{
  to[0] = __builtin_shufflevector(a, b, static_cast<int>(2 * L)...);
  to[1] = __builtin_shufflevector(a, b, static_cast<int>(2 * L + 1)...);
}
/// Lane l of component d is number 3 l + d of a, b, c in a row.
template <int D, class V, std::size_t... L> PDX_INLINE V third(V a, V b, V c, std::index_sequence<L...>)
{
  constexpr std::size_t W = sizeof...(L);
  const V ab = __builtin_shufflevector(a, b, static_cast<int>(3 * L + D < 2 * W ? 3 * L + D : 0)...);
  return __builtin_shufflevector(ab, c, static_cast<int>(3 * L + D < 2 * W ? L : 3 * L + D - W)...);
}
template <int K, class V, std::size_t... L> PDX_INLINE V join(const V (&x)[2], std::index_sequence<L...>)
{
  constexpr std::size_t W = sizeof...(L);
  return __builtin_shufflevector(x[0], x[1], static_cast<int>((K * W + L) % 2 * W + (K * W + L) / 2)...);
}
template <int K, class V, std::size_t... L> PDX_INLINE V join(const V (&x)[3], std::index_sequence<L...>)
{
  constexpr std::size_t W = sizeof...(L);
  const V xy = __builtin_shufflevector(
      x[0], x[1], static_cast<int>((K * W + L) % 3 == 2 ? 0 : (K * W + L) % 3 * W + (K * W + L) / 3)...);
  return __builtin_shufflevector(xy, x[2], static_cast<int>((K * W + L) % 3 == 2 ? W + (K * W + L) / 3 : L)...);
}
template <int By, class V, std::size_t... L> PDX_INLINE V moved(V a, V b, std::index_sequence<L...>)
{
  return __builtin_shufflevector(a, b, static_cast<int>(L + By)...);
}
} // namespace lines

/// Lanes By, By + 1, ... of a and b in a row.
template <int By, int W> PDX_INLINE Lanes<W> moved(Lanes<W> a, Lanes<W> b)
{
  return lines::moved<By>(a, b, std::make_index_sequence<W>());
}

template <int W> PDX_INLINE void load_nodes(const double* p, NodeLanes<W, 2>& x)
{
  lines::part(load<W>(p), load<W>(p + W), x, std::make_index_sequence<W>());
}
template <int W> PDX_INLINE void load_nodes(const double* p, NodeLanes<W, 3>& x)
{
  const auto all = std::make_index_sequence<W>();
  const Lanes<W> a = load<W>(p), b = load<W>(p + W), c = load<W>(p + 2 * W);
  x[0] = lines::third<0>(a, b, c, all);
  x[1] = lines::third<1>(a, b, c, all);
  x[2] = lines::third<2>(a, b, c, all);
}
/// The first `count` nodes; lanes behind them repeat the last.
template <int W, int Dim> PDX_INLINE void load_nodes(const double* p, std::ptrdiff_t count, NodeLanes<W, Dim>& x)
{
  if (count >= W) return load_nodes<W>(p, x);
  for (std::ptrdiff_t l = 0; l < W; ++l)
    for (int d = 0; d < Dim; ++d) x[d][l] = p[std::min(l, count - 1) * Dim + d];
}

template <int W, int Dim> PDX_INLINE void add_nodes(const NodeLanes<W, Dim>& x, double* p)
{
  const auto all = std::make_index_sequence<W>();
  store<W>(load<W>(p) + lines::join<0>(x, all), p);
  store<W>(load<W>(p + W) + lines::join<1>(x, all), p + W);
  if constexpr (Dim == 3) store<W>(load<W>(p + 2 * W) + lines::join<2>(x, all), p + 2 * W);
}
template <int W, int Dim> PDX_INLINE void add_nodes(const NodeLanes<W, Dim>& x, std::ptrdiff_t count, double* p)
{
  if (count >= W) return add_nodes<W, Dim>(x, p);
  for (std::ptrdiff_t l = 0; l < count; ++l)
    for (int d = 0; d < Dim; ++d) p[l * Dim + d] += x[d][l];
}
} // namespace pdx
