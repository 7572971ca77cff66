#pragma once
#include "cell_work.hpp"
#include "pdx/base/node_lanes.hpp"
#include "pdx/mpm/point_kernel.hpp"

/// Full cells of R^Dim points, lanes of neighbouring cells along a run. Gradients by x are the same for points of one y
/// and z: they are blended from edges to levels and stresses summed over x before they are blended back. The first axis
/// here is that of the run, and the first component is along it: in space z, x, y stand for x, y, z, a rotation, which
/// laws do not see.
namespace pdx::mpm {
template <int R> constexpr double level(int i) { return (i + 0.5) / R; }
constexpr int power(int base, int exponent) { return exponent == 0 ? 1 : base * power(base, exponent - 1); }

/// to[levels, fastest first] from values at the ends of edges; and the transpose.
///@{
template <int Axes, int R, class T> PDX_INLINE void to_levels(const T (&edge)[1 << Axes], T (&to)[power(R, Axes)])
{
  if constexpr (Axes == 1) {
    PDX_UNROLL
    for (int i = 0; i < R; ++i) to[i] = level<R>(R - 1 - i) * edge[0] + level<R>(i) * edge[1];
  } else {
    T half[R][2];
    PDX_UNROLL
    for (int b = 0; b < 2; ++b)
      for (int i = 0; i < R; ++i) half[i][b] = level<R>(R - 1 - i) * edge[2 * b] + level<R>(i) * edge[2 * b + 1];
    PDX_UNROLL
    for (int j = 0; j < R; ++j)
      for (int i = 0; i < R; ++i) to[j * R + i] = level<R>(R - 1 - j) * half[i][0] + level<R>(j) * half[i][1];
  }
}
template <int Axes, int R, class T> PDX_INLINE void from_levels(const T (&at)[power(R, Axes)], T (&edge)[1 << Axes])
{
  if constexpr (Axes == 1) {
    edge[0] = level<R>(R - 1) * at[0];
    edge[1] = level<R>(0) * at[0];
    PDX_UNROLL
    for (int i = 1; i < R; ++i) {
      edge[0] += level<R>(R - 1 - i) * at[i];
      edge[1] += level<R>(i) * at[i];
    }
  } else {
    T half[R][2];
    PDX_UNROLL
    for (int i = 0; i < R; ++i) {
      half[i][0] = level<R>(R - 1) * at[i];
      half[i][1] = level<R>(0) * at[i];
      for (int j = 1; j < R; ++j) {
        half[i][0] += level<R>(R - 1 - j) * at[j * R + i];
        half[i][1] += level<R>(j) * at[j * R + i];
      }
    }
    PDX_UNROLL
    for (int b = 0; b < 2; ++b) {
      edge[2 * b] = level<R>(R - 1) * half[0][b];
      edge[2 * b + 1] = level<R>(0) * half[0][b];
      for (int i = 1; i < R; ++i) {
        edge[2 * b] += level<R>(R - 1 - i) * half[i][b];
        edge[2 * b + 1] += level<R>(i) * half[i][b];
      }
    }
  }
}
///@}

/// Lower corner of edge e along axis d: the other bits in order.
constexpr int low_corner(int d, int e) { return (e >> d << (d + 1)) | (e & ((1 << d) - 1)); }
/// Level of the point with site indices i by all axes but d.
template <int Dim, int R> constexpr int level_of(int d, int site)
{
  return site / power(R, d + 1) * power(R, d) + site % power(R, d);
}

template <int Dim, int R, class T>
PDX_INLINE void gradients_at_levels(const T (&x)[kCorners<Dim>][Dim], double per_side,
                                    T (&to)[Dim][Dim][power(R, Dim - 1)])
{
  PDX_UNROLL
  for (int d = 0; d < Dim; ++d)
    for (int c = 0; c < Dim; ++c) {
      T edge[kCorners<Dim> / 2];
      PDX_UNROLL
      for (int e = 0; e < kCorners<Dim> / 2; ++e)
        edge[e] = per_side * (x[low_corner(d, e) | 1 << d][c] - x[low_corner(d, e)][c]);
      to_levels<Dim - 1, R>(edge, to[c][d]);
    }
}

/// Numbers at levels, for each component of a gradient.
template <int Dim, int R, class T> using Levels = T[Dim][Dim][power(R, Dim - 1)];

/// The work at one point of a full cell: stress is added to that of its levels. @return its density
template <int Dim, int R, class Work, class T>
PDX_INLINE T at_site(const Work& work, int site, const Levels<Dim, R, T>& h, const Levels<Dim, R, T>& rate,
                     Levels<Dim, R, T>& stress)
{
  Gradient<Dim, T> here, rate_here, p;
  PDX_UNROLL
  for (int c = 0; c < Dim; ++c)
    for (int d = 0; d < Dim; ++d) {
      here[c][d] = h[c][d][level_of<Dim, R>(d, site)];
      if constexpr (Work::kRates) rate_here[c][d] = rate[c][d][level_of<Dim, R>(d, site)];
    }
  const T density = work.at(here, rate_here, p);
  PDX_UNROLL
  for (int c = 0; c < Dim; ++c)
    for (int d = 0; d < Dim; ++d) {
      T& to = stress[c][d][level_of<Dim, R>(d, site)];
      to = site / power(R, d) % R == 0 ? p[c][d] : to + p[c][d];
    }
  return density;
}

/// f = forces of one cell a lane on its corners. @return density, summed over points
template <int Dim, int R, class Work, class T>
PDX_INLINE T full_cell(const Work& work, double per_side, double volume, const T (&u)[kCorners<Dim>][Dim],
                       const T (&v)[kCorners<Dim>][Dim], T (&f)[kCorners<Dim>][Dim])
{
  Levels<Dim, R, T> h, rate, stress;
  gradients_at_levels<Dim, R>(u, per_side, h);
  if constexpr (Work::kRates) gradients_at_levels<Dim, R>(v, per_side, rate);
  T sum = at_site<Dim, R>(work, 0, h, rate, stress);
  constexpr int sites = power(R, Dim);
  if constexpr (sites > 1) {
    PDX_UNROLL
    for (int site = 1; site < sites; ++site) sum += at_site<Dim, R>(work, site, h, rate, stress);
  }
  PDX_UNROLL
  for (int d = 0; d < Dim; ++d)
    for (int c = 0; c < Dim; ++c) {
      T edge[kCorners<Dim> / 2];
      from_levels<Dim - 1, R>(stress[c][d], edge);
      PDX_UNROLL
      for (int e = 0; e < kCorners<Dim> / 2; ++e) {
        const T part = (volume * per_side) * edge[e];
        const int low = low_corner(d, e), high = low | 1 << d;
        f[low][c] = d == 0 ? -part : f[low][c] - part;
        f[high][c] = d == 0 ? part : f[high][c] + part;
      }
    }
  return sum;
}

/// Is every number 0, of either sign? The first alone tells where things move.
template <int N, int Dim, class T> PDX_INLINE bool all_zero(const T (&x)[N][Dim])
{
  using Words = typename Simd<sizeof(T) / sizeof(double)>::Words;
  if (x[0][0][0] != 0.0) return false;
  Words bits{};
  PDX_UNROLL
  for (int a = 0; a < N; ++a)
    for (int d = 0; d < Dim; ++d) bits |= std::bit_cast<Words>(x[a][d]);
  return !any_true((bits << 1) != 0); // without the sign
}

template <int Dim, class T>
PDX_INLINE void add_hourglass(const CellPoints<Dim>& points, const T (&u)[kCorners<Dim>][Dim],
                              T (&f)[kCorners<Dim>][Dim])
{
  PDX_UNROLL
  for (int mode = 0; mode < kHourglasses<Dim>; ++mode)
    for (int d = 0; d < Dim; ++d) {
      T q{};
      PDX_UNROLL
      for (int a = 0; a < kCorners<Dim>; ++a) q += hourglass_sign(mode, a) * u[a][d];
      q *= points.hourglass[static_cast<std::size_t>(mode)];
      PDX_UNROLL
      for (int a = 0; a < kCorners<Dim>; ++a) f[a][d] += hourglass_sign(mode, a) * q;
    }
}

/// Component of rows that is the d-th of a run.
template <int Dim> constexpr int of_rows(int d) { return Dim == 2 ? d : (d + 2) % 3; }

/// Goes along a run: the lanes of a vector are the nodes it moves over, so that each is loaded and added to once.
template <int W, int Dim, int R, class Work> struct RunSweep {
  static constexpr int kLines = kCorners<Dim> / 2;
  const Work& work;
  const CellPoints<Dim>& points;
  double per_side;
  const NodeFields& fields;
  double sum = 0.0;
  std::int64_t skipped = 0; ///< cells

  PDX_INLINE void along(const CellRun<Dim>& run)
  {
    NodeLanes<W, Dim> u[kLines], v[kLines], next_u[kLines], next_v[kLines], carry[kLines] = {};
    load_lines(fields.u, run, 0, u);
    if constexpr (Work::kRates) load_lines(fields.v, run, 0, v);
    for (std::ptrdiff_t at = 0; at < run.cells; at += W) {
      const std::ptrdiff_t count = run.cells - at; // cells to go
      if (count >= W) {
        load_lines(fields.u, run, at + W, next_u);
        if constexpr (Work::kRates) load_lines(fields.v, run, at + W, next_v);
      } else {
        end_lines(u, next_u);
        if constexpr (Work::kRates) end_lines(v, next_v);
      }
      Lanes<W> here[2 * kLines][Dim], rate[2 * kLines][Dim], f[2 * kLines][Dim];
      to_corners(u, next_u, here);
      if constexpr (Work::kRates) to_corners(v, next_v, rate);
      if (fields.skipped && all_zero(Work::kRates ? rate : here)) {
        skipped += std::min<std::ptrdiff_t>(count, W);
        hand_over(run, at, carry);
      } else {
        Lanes<W> density = full_cell<Dim, R>(work, per_side, points.volume, here, rate, f);
        if constexpr (Work::kHourglass && R == 1) add_hourglass<Dim>(points, here, f);
        if (count < W) drop_behind(count, density, f);
        if constexpr (Work::kSums)
          for (int l = 0; l < W; ++l) sum += density[l];
        add_forces(run, at, count, f, carry);
      }
      PDX_UNROLL
      for (int line = 0; line < kLines; ++line)
        for (int d = 0; d < Dim; ++d) {
          u[line][d] = next_u[line][d];
          if constexpr (Work::kRates) v[line][d] = next_v[line][d];
        }
    }
  }

private:
  static PDX_INLINE void load_lines(const double* from, const CellRun<Dim>& run, std::ptrdiff_t at,
                                    NodeLanes<W, Dim> (&x)[kLines])
  {
    PDX_UNROLL
    for (int line = 0; line < kLines; ++line)
      load_nodes<W, Dim>(from + (run.first[static_cast<std::size_t>(line)] + at) * Dim, run.cells + 1 - at, x[line]);
  }
  /// Nodes behind a run's last are that again: for lanes without a cell that are not calm laws would take longer.
  static PDX_INLINE void end_lines(const NodeLanes<W, Dim> (&x)[kLines], NodeLanes<W, Dim> (&next)[kLines])
  {
    PDX_UNROLL
    for (int line = 0; line < kLines; ++line)
      for (int d = 0; d < Dim; ++d) next[line][d] = Lanes<W>{} + x[line][d][W - 1];
  }
  static PDX_INLINE void to_corners(const NodeLanes<W, Dim> (&x)[kLines], const NodeLanes<W, Dim> (&next)[kLines],
                                    Lanes<W> (&to)[2 * kLines][Dim])
  {
    PDX_UNROLL
    for (int line = 0; line < kLines; ++line)
      for (int d = 0; d < Dim; ++d) {
        to[2 * line][d] = x[line][of_rows<Dim>(d)];
        to[2 * line + 1][d] = moved<1, W>(x[line][of_rows<Dim>(d)], next[line][of_rows<Dim>(d)]);
      }
  }
  /// Lanes from `count` on are no cells.
  static PDX_INLINE void drop_behind(std::ptrdiff_t count, Lanes<W>& density, Lanes<W> (&f)[2 * kLines][Dim])
  {
    for (std::ptrdiff_t l = count; l < W; ++l) {
      density[l] = 0.0;
      for (int a = 0; a < 2 * kLines; ++a)
        for (int d = 0; d < Dim; ++d) f[a][d][l] = 0.0;
    }
  }
  /// Of the last cell of the lanes before, before cells that rest.
  PDX_INLINE void hand_over(const CellRun<Dim>& run, std::ptrdiff_t at, NodeLanes<W, Dim> (&carry)[kLines]) const
  {
    PDX_UNROLL
    for (int line = 0; line < kLines; ++line)
      for (int d = 0; d < Dim; ++d) {
        fields.r[(run.first[static_cast<std::size_t>(line)] + at) * Dim + d] += carry[line][d][W - 1];
        carry[line][d] = Lanes<W>{};
      }
  }
  PDX_INLINE void add_forces(const CellRun<Dim>& run, std::ptrdiff_t at, std::ptrdiff_t count,
                             const Lanes<W> (&f)[2 * kLines][Dim], NodeLanes<W, Dim> (&carry)[kLines]) const
  {
    PDX_UNROLL
    for (int line = 0; line < kLines; ++line) {
      double* const to = fields.r + (run.first[static_cast<std::size_t>(line)] + at) * Dim;
      NodeLanes<W, Dim> both;
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) {
        Lanes<W>& before = carry[line][of_rows<Dim>(d)];
        both[of_rows<Dim>(d)] = f[2 * line][d] + moved<W - 1, W>(before, f[2 * line + 1][d]);
        before = f[2 * line + 1][d];
      }
      add_nodes<W, Dim>(both, count + 1, to);
      if (count == W)
        for (int d = 0; d < Dim; ++d) to[W * Dim + d] += carry[line][d][W - 1];
    }
  }
};
} // namespace pdx::mpm
