#pragma once
#include "grid_shape.hpp"
#include "pdx/base/node_lanes.hpp"
#include "pdx/law/solid_law.hpp"
#include "pdx/mpm/grid_kernel.hpp"

/// Lanes of blocks of cells, and the nodes that their points see.
namespace pdx::mpm {
constexpr int grid_power(int base, int exponent) { return exponent == 0 ? 1 : base * grid_power(base, exponent - 1); }

inline constexpr double kLaneNumbers[] = {0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0};

/// Some lanes of a block.
template <int W, int Dim> struct SomeLanes {
  using Points = PointLanes<Dim>;
  typename Points::Block const& block;
  int lane; ///< the first
  Lanes<W> counts, cell;
  int slots = 0;

  PDX_INLINE SomeLanes(const typename Points::Block& of, int from)
      : block(of), lane(from), counts(load<W>(of.counts + from)),
        cell(load<W>(kLaneNumbers + from) + static_cast<double>(of.cell[0])), slots(of.slots)
  {
    if constexpr (W == Points::kLanes) return;
    double most = 0.0;
    for (int l = 0; l < W; ++l) most = std::max(most, counts[l]);
    slots = static_cast<int>(most);
  }
  /// 1 where there is a point, else 0: numbers, for which all widths have instructions.
  PDX_INLINE Lanes<W> live(int slot) const
  {
    return counts > Lanes<W>{} + static_cast<double>(slot) ? Lanes<W>{} + 1.0 : Lanes<W>{};
  }
  /// Place in its cell along an axis.
  PDX_INLINE Lanes<W> within(int d, Lanes<W> at) const
  {
    return d == 0 ? at - cell : at - static_cast<double>(block.cell[static_cast<std::size_t>(d)]);
  }
};

/// Values at the nodes that points of a cell see, x fastest: products of those along the axes.
template <int W, int Dim, class Shape> struct Weights {
  static constexpr int kReach = Shape::kReach, kNodes = grid_power(kReach, Dim);
  Lanes<W> n[Dim][kReach], g[Dim][kReach];

  PDX_INLINE Weights(const Shape& shape, const SomeLanes<W, Dim>& lanes, const Lanes<W> (&at)[Dim])
  {
    PDX_UNROLL
    for (int d = 0; d < Dim; ++d) shape.at(lanes.within(d, at[d]), n[d], g[d]);
  }
  PDX_INLINE Lanes<W> value(int node) const
  {
    Lanes<W> product = n[0][node % kReach] * n[1][node / kReach % kReach];
    if constexpr (Dim == 3) product *= n[2][node / (kReach * kReach)];
    return product;
  }
  PDX_INLINE Lanes<W> slope(int node, int d) const
  {
    Lanes<W> product = (d == 0 ? g : n)[0][node % kReach] * (d == 1 ? g : n)[1][node / kReach % kReach];
    if constexpr (Dim == 3) product *= (d == 2 ? g : n)[2][node / (kReach * kReach)];
    return product;
  }
};

template <int Dim, class Shape>
PDX_INLINE std::ptrdiff_t first_node(const NodeView<Dim>& nodes, const Site<Dim>& cell, int lane)
{
  std::ptrdiff_t at = lane;
  for (std::size_t d = 0; d < Dim; ++d) at += (cell[d] + Shape::kFirst - nodes.lower[d]) * nodes.step[d];
  return at;
}
/// From the first node of a cell to the first of a line along x.
template <int Dim, int Reach> PDX_INLINE std::ptrdiff_t line_start(const NodeView<Dim>& nodes, int line)
{
  std::ptrdiff_t at = line % Reach * nodes.step[1];
  if constexpr (Dim == 3) at += line / Reach * nodes.step[2];
  return at;
}

/// Adds what each lane has for the nodes along a line, lane l's first at to[l].
template <int W> PDX_INLINE void add_along(const Lanes<W> (&sum)[2], double* to)
{
  store<W>(load<W>(to) + (sum[0] + moved<W - 1, W>(Lanes<W>{}, sum[1])), to);
  to[W] += sum[1][W - 1];
}
template <int W> PDX_INLINE void add_along(const Lanes<W> (&sum)[3], double* to)
{
  store<W>(load<W>(to) + (sum[0] + moved<W - 1, W>(Lanes<W>{}, sum[1]) + moved<W - 2, W>(Lanes<W>{}, sum[2])), to);
  to[W] += sum[1][W - 1] + sum[2][W - 2];
  to[W + 1] += sum[2][W - 1];
}
template <int W, int Dim, int Reach>
PDX_INLINE void add_all(const Lanes<W> (&sum)[grid_power(Reach, Dim)], const NodeView<Dim>& nodes, double* first)
{
  for (int line = 0; line < grid_power(Reach, Dim - 1); ++line)
    add_along<W>(reinterpret_cast<const Lanes<W>(&)[Reach]>(sum[line * Reach]),
                 first + line_start<Dim, Reach>(nodes, line));
}

template <int W, int Dim> PDX_INLINE void load_numbers(const double* from, Lanes<W> (&to)[Dim])
{
  PDX_UNROLL
  for (int d = 0; d < Dim; ++d) to[d] = load<W>(from + d * PointLanes<Dim>::kLanes);
}
template <int W, int Dim> PDX_INLINE void load_strain(const double* from, Lanes<W> (&h)[Dim][Dim])
{
  PDX_UNROLL
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) h[i][j] = load<W>(from + (2 * Dim + Dim * i + j) * PointLanes<Dim>::kLanes);
}
} // namespace pdx::mpm
