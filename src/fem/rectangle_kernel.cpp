#include "lane_pair.hpp"
#include "pdx/base/node_lanes.hpp"
#include "pdx/fem/sweep_kernel.hpp"

#include <cmath>

/// In a rectangle du/dx depends on y alone and du/dy on x alone: two vectors each instead of four gradients.
namespace pdx::fem {
namespace rectangles {
/// Constants of the elements of a run; the stiffness is that of a Gauss point.
struct Constants {
  double per_along, per_across; // [1/m]
  double c11, c12, mu;          // [J]
  Constants(const RectangleRun& run, const law::Elastic& law) : per_along(1.0 / run.along), per_across(1.0 / run.across)
  {
    const double volume = 0.25 * std::abs(run.along * run.across) * law.thickness;
    c11 = volume * law.c11();
    c12 = volume * law.c12();
    mu = volume * law.mu();
  }
};

/// Forces on the corners of W elements, or else their energies.
template <bool finite, bool forces, class T>
PDX_INLINE T element(const Constants& m, const Pair<T> (&u)[4], Pair<T> (&f)[4])
{
  Pair<T> a[2], b[2]; // derivatives of u along the lines, on either Gauss line, and across
  to_points(m.per_along * (u[1] - u[0]), m.per_along * (u[2] - u[3]), a);
  to_points(m.per_across * (u[3] - u[0]), m.per_across * (u[2] - u[1]), b);
  T xx[2], yy[2], sx[2], sy[2], shear[2][2]; // shear[i][j] at the point of b[i], a[j]
  PDX_UNROLL
  for (int j = 0; j < 2; ++j) {
    xx[j] = finite ? a[j].x + 0.5 * dot(a[j], a[j]) : a[j].x;
    yy[j] = finite ? b[j].y + 0.5 * dot(b[j], b[j]) : b[j].y;
    for (int i = 0; i < 2; ++i) {
      shear[i][j] = a[j].y + b[i].x;
      if constexpr (finite) shear[i][j] += dot(a[j], b[i]);
    }
  }
  PDX_UNROLL
  for (int j = 0; j < 2; ++j) { // stress of both points of a line
    sx[j] = (2.0 * m.c11) * xx[j] + m.c12 * (yy[0] + yy[1]);
    sy[j] = (2.0 * m.c11) * yy[j] + m.c12 * (xx[0] + xx[1]);
  }
  if constexpr (forces) {
    Pair<T> along[2], across[2];
    if constexpr (finite) {
      Pair<T> fx[2], fy[2]; // columns of the deformation gradient
      PDX_UNROLL
      for (int j = 0; j < 2; ++j) {
        fx[j] = {1.0 + a[j].x, a[j].y};
        fy[j] = {b[j].x, 1.0 + b[j].y};
      }
      PDX_UNROLL
      for (int j = 0; j < 2; ++j) {
        along[j] = sx[j] * fx[j] + m.mu * (shear[0][j] * fy[0] + shear[1][j] * fy[1]);
        across[j] = sy[j] * fy[j] + m.mu * (shear[j][0] * fx[0] + shear[j][1] * fx[1]);
      }
    } else {
      PDX_UNROLL
      for (int j = 0; j < 2; ++j) {
        along[j] = {sx[j], m.mu * (shear[0][j] + shear[1][j])};
        across[j] = {m.mu * (shear[j][0] + shear[j][1]), sy[j]};
      }
    }
    PDX_UNROLL
    for (int j = 0; j < 2; ++j) {
      along[j] = m.per_along * along[j];
      across[j] = m.per_across * across[j];
    }
    to_corners(along, across, f);
  }
  T energy{};
  if constexpr (!forces) {
    PDX_UNROLL
    for (int j = 0; j < 2; ++j)
      energy += 0.5 * (sx[j] * xx[j] + sy[j] * yy[j] + m.mu * (shear[0][j] * shear[0][j] + shear[1][j] * shear[1][j]));
  }
  return energy;
}

/// The first `count` of 2 W numbers, with zeros behind, where the array ends too early for whole vectors.
template <int W> __attribute__((noinline)) const double* padded(const double* from, std::ptrdiff_t count, double* to)
{
  for (std::ptrdiff_t k = 0; k < 2 * W; ++k) to[k] = k < count ? from[k] : 0.0;
  return to;
}
__attribute__((noinline)) void add_some(const double* x, std::ptrdiff_t count, double* to)
{
  for (std::ptrdiff_t k = 0; k < count; ++k) to[k] += x[k];
}

/// Goes along a run: the lanes of a vector are the nodes it moves over, so that each is loaded and added to once.
template <int W, bool finite, bool forces, bool turned> struct RunSweep {
  using T = Lanes<W>;
  const SweepFields& fields;
  const RectangleRun& run;
  const Constants constants;
  T energy;
  Pair<T> carry[2] = {}; // of either line: what the elements before do to their last nodes

  PDX_INLINE void along()
  {
    Pair<T> here[2];
    PDX_UNROLL
    for (int line = 0; line < 2; ++line) here[line] = nodes(line, 0);
    std::ptrdiff_t at = 0;
    for (; at + W <= run.elements; at += W) {
      Pair<T> next[2];
      PDX_UNROLL
      for (int line = 0; line < 2; ++line) next[line] = nodes(line, at + W);
      Pair<T> f[4];
      energy += elements(here, next, f);
      if constexpr (forces) {
        PDX_UNROLL
        for (int line = 0; line < 2; ++line) {
          if (double* const to = line_of(line)) add_full(joined(line, f), to + 2 * at);
          here[line] = next[line];
        }
      } else {
        here[0] = next[0];
        here[1] = next[1];
      }
    }
    end(at, here);
  }

private:
  /// The elements that are left, fewer than lanes, and the last nodes.
  PDX_INLINE void end(std::ptrdiff_t at, const Pair<T> (&here)[2])
  {
    const std::int64_t left = run.elements - at;
    if (left == 0) {
      if constexpr (forces)
        for (int line = 0; line < 2; ++line)
          if (double* const to = line_of(line)) {
            to[2 * at + (turned ? 1 : 0)] += carry[line].x[W - 1];
            to[2 * at + (turned ? 0 : 1)] += carry[line].y[W - 1];
          }
      return;
    }
    Pair<T> f[4];
    const auto on = first_lanes(left);
    const T energies = elements(here, here, f);
    energy += on ? energies : T{};
    if constexpr (forces) {
      PDX_UNROLL
      for (int a = 0; a < 4; ++a) f[a] = {on ? f[a].x : T{}, on ? f[a].y : T{}};
      for (int line = 0; line < 2; ++line)
        if (double* const to = line_of(line)) add(joined(line, f), first(line) + at, left + 1, to + 2 * at);
    }
  }

  PDX_INLINE std::ptrdiff_t first(int line) const { return run.first[static_cast<std::size_t>(line)]; }
  /// Forces of the line, or none where other ranks add them up.
  PDX_INLINE double* line_of(int line) const
  {
    return first(line) < fields.owned ? fields.r + 2 * first(line) : nullptr;
  }
  /// Nodes from number `at` of a line on; lanes behind its last may be of any row.
  PDX_INLINE Pair<T> nodes(int line, std::ptrdiff_t at) const
  {
    const std::ptrdiff_t row = first(line) + at, count = fields.rows - row;
    double end[2 * W];
    NodeLanes<W, 2> x;
    load_nodes<W>(count < W ? padded<W>(fields.u + 2 * row, 2 * count, end) : fields.u + 2 * row, x);
    return {x[turned ? 1 : 0], x[turned ? 0 : 1]};
  }
  PDX_INLINE T elements(const Pair<T> (&here)[2], const Pair<T> (&next)[2], Pair<T> (&f)[4]) const
  {
    const Pair<T> u[4] = {here[0], behind(here[0], next[0]), behind(here[1], next[1]), here[1]};
    return element<finite, forces>(constants, u, f);
  }
  static PDX_INLINE Pair<T> behind(const Pair<T>& here, const Pair<T>& next)
  {
    return {moved<1, W>(here.x, next.x), moved<1, W>(here.y, next.y)};
  }
  /// Forces on the nodes of a line: of the elements ahead and behind.
  PDX_INLINE Pair<T> joined(int line, const Pair<T> (&f)[4])
  {
    const Pair<T>& ahead = f[line == 0 ? 0 : 3];
    const Pair<T>& last = f[line == 0 ? 1 : 2];
    const Pair<T> sum{ahead.x + moved<W - 1, W>(carry[line].x, last.x),
                      ahead.y + moved<W - 1, W>(carry[line].y, last.y)};
    carry[line] = last;
    return sum;
  }
  static PDX_INLINE void add_full(const Pair<T>& sum, double* to)
  {
    const NodeLanes<W, 2> x = {turned ? sum.y : sum.x, turned ? sum.x : sum.y};
    add_nodes<W, 2>(x, to);
  }
  /// To `count` nodes, behind which lanes are zero.
  PDX_INLINE void add(const Pair<T>& sum, std::ptrdiff_t row, std::ptrdiff_t count, double* to) const
  {
    if (row + W <= fields.owned) return add_full(sum, to);
    double end[2 * W] = {};
    add_full(sum, end);
    add_some(end, 2 * count, to);
  }
  static PDX_INLINE typename Simd<W>::Mask first_lanes(std::int64_t count)
  {
    typename Simd<W>::Mask lane;
    for (int l = 0; l < W; ++l) lane[l] = l;
    return lane < count;
  }
};

struct Sweep {
  std::span<const RectangleRun> runs;
  const law::Elastic& law;
  Kinematics kinematics;
  const SweepFields& fields;
  double& energy;

  template <int W> PDX_INLINE void run() const
  {
    if (fields.r)
      kinematics == Kinematics::finite ? over_runs<W, true, true>() : over_runs<W, false, true>();
    else
      kinematics == Kinematics::finite ? over_runs<W, true, false>() : over_runs<W, false, false>();
  }

private:
  template <int W, bool finite, bool forces> PDX_INLINE void over_runs() const
  {
    Lanes<W> sum{};
    for (const RectangleRun& one : runs)
      if (one.turned)
        sum = along<W, finite, forces, true>(one, sum);
      else
        sum = along<W, finite, forces, false>(one, sum);
    if constexpr (!forces)
      for (int l = 0; l < W; ++l) energy += sum[l];
  }
  template <int W, bool finite, bool forces, bool turned>
  PDX_INLINE Lanes<W> along(const RectangleRun& one, Lanes<W> sum) const
  {
    RunSweep<W, finite, forces, turned> sweep{fields, one, Constants(one, law), sum};
    sweep.along();
    return sweep.energy;
  }
};
} // namespace rectangles

void add_sweep_forces(Processor processor, std::span<const RectangleRun> runs, const law::Elastic& law,
                      Kinematics kinematics, const SweepFields& fields)
{
  double energy = 0.0;
  run_on(processor, rectangles::Sweep{runs, law, kinematics, fields, energy});
}

double sweep_energy(Processor processor, std::span<const RectangleRun> runs, const law::Elastic& law,
                    Kinematics kinematics, const SweepFields& fields)
{
  double energy = 0.0;
  const SweepFields read{fields.u, fields.rows, nullptr, 0};
  run_on(processor, rectangles::Sweep{runs, law, kinematics, read, energy});
  return energy;
}
} // namespace pdx::fem
