#include "pdx/pd/strip_kernel.hpp"

#include "pdx/base/lanes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pdx::pd {
namespace {
constexpr int degree_of(Series series) { return series == Series::fifth ? 5 : series == Series::seventh ? 7 : 11; }
constexpr int kDegreeMax = 11;

/// Coefficients of (1 - 1/sqrt(1 + e)) / e for |e| <= range by Chebyshev interpolation, in powers of e.
struct SeriesTable {
  double c[3][kDegreeMax + 1] = {};
  SeriesTable()
  {
    for (const Series series : {Series::fifth, Series::seventh, Series::eleventh}) fit(series);
  }

private:
  void fit(Series series)
  {
    using Long = long double;
    constexpr int points = 64;
    const int degree = degree_of(series);
    const Long range = series_range(series);
    Long power[kDegreeMax + 1] = {}, before[kDegreeMax + 1] = {}, chebyshev[kDegreeMax + 1] = {1.0L};
    for (int k = 0; k <= degree; ++k) {
      Long sum = 0.0L;
      for (int i = 0; i < points; ++i) {
        const Long angle = std::numbers::pi_v<Long> * (i + 0.5L) / points;
        const Long root = std::sqrt(1.0L + range * std::cos(angle));
        sum += std::cos(k * angle) / (root * (1.0L + root));
      }
      for (int i = 0; i <= k; ++i) power[i] += chebyshev[i] * sum * (k ? 2.0L : 1.0L) / points;
      Long next[kDegreeMax + 1] = {}; // T_(k+1) = 2 e/range T_k - T_(k-1); T_1 has no T_(-1)
      for (int i = 0; i < degree; ++i) next[i + 1] = (k ? 2.0L : 1.0L) * chebyshev[i] / range;
      for (int i = 0; i <= degree; ++i) {
        next[i] -= before[i];
        before[i] = chebyshev[i];
        chebyshev[i] = next[i];
      }
    }
    for (int i = 0; i <= degree; ++i) c[static_cast<int>(series)][i] = static_cast<double>(power[i]);
  }
};
const SeriesTable kSeries;

/// The laws: what grows with a bond, and s / (1 + s) (finite) or s (linear) by it; the force is that times
/// kappa / |xi| along `arrow`.
template <int Dim, Series series> struct Finite {
  template <int W> static PDX_INLINE Lanes<W> arrow(double xi, Lanes<W> eta) { return xi + eta; }
  template <int W> static PDX_INLINE Lanes<W> growth(double xi, Lanes<W> eta, Lanes<W> y) { return (xi + y) * eta; }
  template <int W>
  static PDX_INLINE Lanes<W> shorten(Lanes<W> e, const StripArm<Dim>& arm, const Lanes<W> (&y)[Dim],
                                     typename Simd<W>::Mask intact)
  {
    if constexpr (series == Series::none) {
      Lanes<W> square{};
      for (int d = 0; d < Dim; ++d) square += y[d] * y[d];
      square *= arm.per_square;
      return intact ? e / (square + square_root<W>(square)) : Lanes<W>{};
    } else {
      const double* c = kSeries.c[static_cast<int>(series)];
      Lanes<W> sum = Lanes<W>{} + c[degree_of(series)];
      PDX_UNROLL
      for (int k = degree_of(series) - 1; k >= 0; --k) sum = sum * e + c[k];
      return e * sum;
    }
  }
  /// s^2 / shortened, where s = shortened / (1 - shortened) and 1 + e = 1 / (1 - shortened)^2.
  template <int W> static PDX_INLINE Lanes<W> work(Lanes<W> shortened, Lanes<W> e) { return shortened + shortened * e; }
};
template <int Dim> struct Linear {
  template <int W> static PDX_INLINE double arrow(double xi, Lanes<W>) { return xi; }
  template <int W> static PDX_INLINE Lanes<W> growth(double xi, Lanes<W> eta, double) { return xi * eta; }
  template <int W>
  static PDX_INLINE Lanes<W> shorten(Lanes<W> s, const StripArm<Dim>&, const double (&)[Dim], typename Simd<W>::Mask)
  {
    return s;
  }
  template <int W> static PDX_INLINE Lanes<W> work(Lanes<W> s, Lanes<W>) { return s; }
};

/// Extremes and energy of the bonds seen so far, by lane.
template <int W> struct Seen {
  Lanes<W> lowest{}, highest{}, energy{};
};

/// The bonds that start at the W particles of one vector.
template <int W, class Law, bool scaled, bool energetic, int Dim>
PDX_INLINE void sweep_vector(const StripView<Dim>& view, std::ptrdiff_t vector, Seen<W>& seen)
{
  constexpr std::ptrdiff_t block = StripView<Dim>::kParts * W;
  double* const here = view.blocks + vector * block;
  Lanes<W> u[Dim], own[Dim] = {};
  for (int d = 0; d < Dim; ++d) u[d] = load<W>(here + d * W);
  [[maybe_unused]] const double* const factor =
      scaled ? view.factors + view.classes[vector] * static_cast<std::ptrdiff_t>(view.arms.size()) * W : nullptr;
  for (std::size_t from = 0; from < view.arms.size(); from += 64) {
    const auto word = load<W>(view.words[from / 64] + vector * W);
    const StripArm<Dim>* const last = view.arms.data() + std::min(from + 64, view.arms.size());
    for (const StripArm<Dim>* arm = view.arms.data() + from; arm != last; ++arm) {
      double* const there = here + arm->jump;
      const typename Simd<W>::Mask intact = (word & arm->bit) != 0;
      Lanes<W> growth{};
      decltype(Law::template arrow<W>(0.0, growth)) y[Dim];
      for (int d = 0; d < Dim; ++d) {
        const Lanes<W> eta = load<W>(there + d * W) - u[d];
        y[d] = Law::template arrow<W>(arm->xi[d], eta);
        growth += Law::template growth<W>(arm->xi[d], eta, y[d]);
      }
      const Lanes<W> e = intact ? growth * arm->per_square : Lanes<W>{};
      seen.lowest = e < seen.lowest ? e : seen.lowest;
      seen.highest = e > seen.highest ? e : seen.highest;
      const Lanes<W> shortened = Law::template shorten<W>(e, *arm, y, intact);
      Lanes<W> pull = shortened * arm->stiffness;
      [[maybe_unused]] const std::ptrdiff_t j = vector * W + arm->jump / StripView<Dim>::kParts;
      if constexpr (scaled) pull *= load<W>(factor + (arm - view.arms.data()) * W);
      if constexpr (energetic) {
        const Lanes<W> ends = load<W>(view.ends + vector * W) + load<W>(view.ends + j);
        seen.energy += 0.5 * arm->length * arm->length * pull * Law::template work<W>(shortened, e) * ends;
      }
      for (int d = 0; d < Dim; ++d) {
        const Lanes<W> force = pull * y[d];
        own[d] += force;
        store<W>(load<W>(there + (Dim + d) * W) - force, there + (Dim + d) * W);
      }
    }
  }
  for (int d = 0; d < Dim; ++d) store<W>(load<W>(here + (Dim + d) * W) + own[d], here + (Dim + d) * W);
}

template <int W> PDX_INLINE double sum_of(Lanes<W> x)
{
  double sum = 0.0;
  for (int l = 0; l < W; ++l) sum += x[l];
  return sum;
}

template <int Dim> struct SweepStrips {
  const StripView<Dim>& view;
  Kinematics kinematics;
  std::span<StripTask> tasks;
  bool energetic;

  template <int W> PDX_INLINE void run() const
  {
    for (StripTask& task : tasks) {
      if (kinematics == Kinematics::small)
        with_law<W, Linear<Dim>>(task);
      else if (task.series == Series::fifth)
        with_law<W, Finite<Dim, Series::fifth>>(task);
      else if (task.series == Series::seventh)
        with_law<W, Finite<Dim, Series::seventh>>(task);
      else if (task.series == Series::eleventh)
        with_law<W, Finite<Dim, Series::eleventh>>(task);
      else
        with_law<W, Finite<Dim, Series::none>>(task);
    }
  }

private:
  template <int W, class Law> PDX_INLINE void with_law(StripTask& task) const
  {
    if (energetic)
      task.scaled ? sweep_box<W, Law, true, true>(task) : sweep_box<W, Law, false, true>(task);
    else
      task.scaled ? sweep_box<W, Law, true, false>(task) : sweep_box<W, Law, false, false>(task);
  }

  template <int W, class Law, bool scaled, bool with_energy> PDX_INLINE void sweep_box(StripTask& task) const
  {
    Seen<W> seen;
    Lanes<W> highest{};
    const StripBox& box = task.box;
    task.lines = {box.lines, 0};
    task.planes = {box.planes, 0};
    for (int plane = 0; plane < box.planes; ++plane)
      for (int line = 0; line < box.lines; ++line) {
        const std::ptrdiff_t first = box.first + plane * box.plane + line * box.line;
        seen.highest = Lanes<W>{};
        for (int c = 0; c < box.columns; ++c)
          if (scaled && view.classes[first + c])
            sweep_vector<W, Law, true, with_energy>(view, first + c, seen);
          else
            sweep_vector<W, Law, false, with_energy>(view, first + c, seen);
        highest = seen.highest > highest ? seen.highest : highest;
        if (!any_true(seen.highest > task.limit)) continue;
        task.lines = {std::min(task.lines[0], line), std::max(task.lines[1], line + 1)};
        task.planes = {std::min(task.planes[0], plane), std::max(task.planes[1], plane + 1)};
      }
    task.lowest = task.highest = 0.0;
    for (int l = 0; l < W; ++l) {
      task.lowest = std::min(task.lowest, seen.lowest[l]);
      task.highest = std::max(task.highest, highest[l]);
    }
    task.energy = with_energy ? sum_of<W>(seen.energy) : 0.0;
  }
};
} // namespace

namespace {
/// Every component of both halves of the ghost columns of one line: visit(ghost lane 0, lane 0 of its twin, shift),
/// where lane l of the ghost is lane l + shift of the twin.
template <int W, int Dim, class Visit> PDX_INLINE void for_each_ghost(double* line, const StripLines& at, Visit visit)
{
  constexpr int block = StripView<Dim>::kParts * W;
  for (int c = 0; c < at.ghosts; ++c) {
    visit(line + (at.ghosts + at.columns + c) * block, line + (at.ghosts + c) * block, 1);
    visit(line + c * block, line + (at.columns + c) * block, -1);
  }
}

/// What is done to one line.
template <int Dim> struct FillGhosts {
  template <int W> static PDX_INLINE void on(double* line, const StripLines& at)
  {
    for_each_ghost<W, Dim>(line, at, [](double* ghost, const double* twin, int shift) {
      for (int d = 0; d < Dim; ++d)
        for (int l = 0; l < W - 1; ++l) ghost[d * W + l + (shift < 0)] = twin[d * W + l + (shift > 0)];
    });
  }
};
template <int Dim> struct FoldGhosts {
  template <int W> static PDX_INLINE void on(double* line, const StripLines& at)
  {
    for_each_ghost<W, Dim>(line, at, [](const double* ghost, double* twin, int shift) {
      for (int d = Dim; d < StripView<Dim>::kParts; ++d)
        for (int l = 0; l < W - 1; ++l) twin[d * W + l + (shift > 0)] += ghost[d * W + l + (shift < 0)];
    });
  }
};
template <int Dim> struct ClearForces {
  template <int W> static PDX_INLINE void on(double* block, const StripLines& at)
  {
    for (std::ptrdiff_t c = 0; c < at.pitch(); ++c, block += StripView<Dim>::kParts * W)
      for (int d = Dim; d < StripView<Dim>::kParts; ++d) store<W>(Lanes<W>{}, block + d * W);
  }
};

template <int Dim, template <int> class Operation> struct EachLine {
  double* blocks;
  const StripLines& at;
  template <int W> PDX_INLINE void run() const
  {
    for (const std::ptrdiff_t line : at.lines)
      Operation<Dim>::template on<W>(blocks + line * at.pitch() * StripView<Dim>::kParts * W, at);
  }
};
} // namespace

template <int Dim> void fill_ghosts(Processor processor, double* blocks, const StripLines& at)
{
  run_on(processor, EachLine<Dim, FillGhosts>{blocks, at});
}
template <int Dim> void fold_ghosts(Processor processor, double* blocks, const StripLines& at)
{
  run_on(processor, EachLine<Dim, FoldGhosts>{blocks, at});
}
template <int Dim> void clear_forces(Processor processor, double* blocks, const StripLines& at)
{
  run_on(processor, EachLine<Dim, ClearForces>{blocks, at});
}

template <int Dim>
void sweep_strips(Processor processor, const StripView<Dim>& view, Kinematics kinematics, std::span<StripTask> tasks,
                  bool energetic)
{
  run_on(processor, SweepStrips<Dim>{view, kinematics, tasks, energetic});
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void fill_ghosts<Dim>(Processor, double*, const StripLines&);                                               \
  template void fold_ghosts<Dim>(Processor, double*, const StripLines&);                                               \
  template void clear_forces<Dim>(Processor, double*, const StripLines&);                                              \
  template void sweep_strips<Dim>(Processor, const StripView<Dim>&, Kinematics, std::span<StripTask>, bool)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::pd
