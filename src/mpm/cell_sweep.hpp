#pragma once
#include "run_sweep.hpp"

/// Cells with any points and corners anywhere, a cell a lane.
namespace pdx::mpm {
template <int W, int Dim, class Work> struct CellSweep {
  static constexpr int kCells = W;
  const Work& work;
  const CellPoints<Dim>& points;
  const NodeFields& fields;
  double sum = 0.0;
  std::int64_t skipped = 0; ///< cells

  PDX_INLINE void over(std::span<const CellRows<Dim>> cells)
  {
    for (std::size_t from = 0; from < cells.size(); from += W) {
      const std::size_t count = std::min<std::size_t>(W, cells.size() - from);
      some(cells.data() + from, static_cast<int>(count));
    }
  }

private:
  using Corners = Lanes<W>[kCorners<Dim>][Dim];

  PDX_INLINE void some(const CellRows<Dim>* cells, int count)
  {
    Corners u, v, f = {};
    gather(fields.u, cells, count, u);
    if constexpr (Work::kRates) gather(fields.v, cells, count, v);
    if (fields.skipped && all_zero(Work::kRates ? v : u)) {
      skipped += count;
      return;
    }
    Lanes<W> total{};
    for (std::size_t p = 0; p < points.gradients.size(); ++p) {
      const double* const g = points.gradients[p].data(); // by corner, then by direction
      Gradient<Dim, Lanes<W>> h, rate, stress;
      gradient(u, g, h);
      if constexpr (Work::kRates) gradient(v, g, rate);
      const Lanes<W> density = work.at(h, rate, stress);
      if constexpr (Work::kSums) total += density;
      if constexpr (Work::kForces) add_force(stress, g, f);
    }
    if constexpr (Work::kForces) {
      PDX_UNROLL
      for (int a = 0; a < kCorners<Dim>; ++a)
        for (int d = 0; d < Dim; ++d) f[a][d] *= points.volume;
      if constexpr (Work::kHourglass)
        if (points.held) add_hourglass<Dim>(points, u, f);
      scatter(f, cells, count);
    }
    if constexpr (Work::kSums) {
      total *= points.volume;
      if constexpr (!Work::kForces)
        if (points.held) total += hourglass_energy(u);
      for (int l = 0; l < count; ++l) sum += total[l];
    }
  }

  static PDX_INLINE void gather(const double* from, const CellRows<Dim>* cells, int count, Corners& x)
  {
    for (int a = 0; a < kCorners<Dim>; ++a)
      for (int l = 0; l < W; ++l) {
        const double* const node =
            from + static_cast<std::ptrdiff_t>(cells[std::min(l, count - 1)][static_cast<std::size_t>(a)]) * Dim;
        for (int d = 0; d < Dim; ++d) x[a][d][l] = node[d];
      }
  }
  PDX_INLINE void scatter(const Corners& f, const CellRows<Dim>* cells, int count) const
  {
    for (int l = 0; l < count; ++l)
      for (int a = 0; a < kCorners<Dim>; ++a) {
        const Index row = cells[l][static_cast<std::size_t>(a)];
        if (row >= fields.owned) continue;
        double* const to = fields.r + static_cast<std::ptrdiff_t>(row) * Dim;
        for (int d = 0; d < Dim; ++d) to[d] += f[a][d][l];
      }
  }
  static PDX_INLINE void gradient(const Corners& x, const double* g, Gradient<Dim, Lanes<W>>& h)
  {
    PDX_UNROLL
    for (int c = 0; c < Dim; ++c)
      for (int d = 0; d < Dim; ++d) {
        h[c][d] = g[d * kCorners<Dim>] * x[0][c];
        PDX_UNROLL
        for (int a = 1; a < kCorners<Dim>; ++a) h[c][d] += g[d * kCorners<Dim> + a] * x[a][c];
      }
  }
  static PDX_INLINE void add_force(const Gradient<Dim, Lanes<W>>& stress, const double* g, Corners& f)
  {
    PDX_UNROLL
    for (int a = 0; a < kCorners<Dim>; ++a)
      for (int c = 0; c < Dim; ++c)
        for (int d = 0; d < Dim; ++d) f[a][c] += g[d * kCorners<Dim> + a] * stress[c][d];
  }
  PDX_INLINE Lanes<W> hourglass_energy(const Corners& u) const
  {
    Corners f = {};
    add_hourglass<Dim>(points, u, f);
    Lanes<W> twice{};
    for (int a = 0; a < kCorners<Dim>; ++a)
      for (int d = 0; d < Dim; ++d) twice += u[a][d] * f[a][d];
    return 0.5 * twice;
  }
};
} // namespace pdx::mpm
