#include "pdx/couple/run_kernel.hpp"

#include "pdx/base/lanes.hpp"

namespace pdx::couple {
namespace run_kernel {
/// Of W neighbouring rows of two components: either component by itself, and back.
template <int W> PDX_INLINE void part(const double* rows, Lanes<W> (&x)[2])
{
  const Lanes<W> low = load<W>(rows), high = load<W>(rows + W);
  if constexpr (W == 8) {
    x[0] = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
    x[1] = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
  } else if constexpr (W == 4) {
    x[0] = __builtin_shufflevector(low, high, 0, 2, 4, 6);
    x[1] = __builtin_shufflevector(low, high, 1, 3, 5, 7);
  } else {
    x[0] = __builtin_shufflevector(low, high, 0, 2);
    x[1] = __builtin_shufflevector(low, high, 1, 3);
  }
}
template <int W> PDX_INLINE void join_onto(double* rows, const Lanes<W> (&x)[2])
{
  Lanes<W> low, high;
  if constexpr (W == 8) {
    low = __builtin_shufflevector(x[0], x[1], 0, 8, 1, 9, 2, 10, 3, 11);
    high = __builtin_shufflevector(x[0], x[1], 4, 12, 5, 13, 6, 14, 7, 15);
  } else if constexpr (W == 4) {
    low = __builtin_shufflevector(x[0], x[1], 0, 4, 1, 5);
    high = __builtin_shufflevector(x[0], x[1], 2, 6, 3, 7);
  } else {
    low = __builtin_shufflevector(x[0], x[1], 0, 2);
    high = __builtin_shufflevector(x[0], x[1], 1, 3);
  }
  store<W>(load<W>(rows) + low, rows);
  store<W>(load<W>(rows + W) + high, rows + W);
}
template <int W> PDX_INLINE double folded(Lanes<W> x)
{
  if constexpr (W == 8) x += __builtin_shufflevector(x, x, 4, 5, 6, 7, 0, 1, 2, 3);
  if constexpr (W == 8) x += __builtin_shufflevector(x, x, 2, 3, 0, 1, 6, 7, 4, 5);
  if constexpr (W == 4) x += __builtin_shufflevector(x, x, 2, 3, 0, 1);
  return x[0] + x[1];
}

/// How e becomes what the force grows with: s by itself, or s / (1 + s) = 1 - 1/sqrt(1 + e), near 0 by its series, to
/// rounding, elsewhere by root and division.
enum class Growth { linear, near, far };
constexpr double kNear = 0.01; // the first term left out is 2^-54 of the sum there
template <int W, Growth growth> PDX_INLINE Lanes<W> shortened(Lanes<W> e)
{
  if constexpr (growth == Growth::linear) return e;
  if constexpr (growth == Growth::near) {
    constexpr double c[] = {1.0 / 2,    -3.0 / 8,      5.0 / 16,     -35.0 / 128,
                            63.0 / 256, -231.0 / 1024, 429.0 / 2048, -6435.0 / 32768};
    Lanes<W> sum = Lanes<W>{} + c[7];
    PDX_UNROLL
    for (int k = 6; k >= 0; --k) sum = sum * e + c[k];
    return e * sum;
  }
  const Lanes<W> square = 1.0 + e;
  return e / (square + square_root<W>(square));
}

/// Of intact bonds; 0 is among them.
template <int W> struct Extremes {
  Lanes<W> least{}, most{};
  PDX_INLINE void see(Lanes<W> e)
  {
    least = e < least ? e : least;
    most = e > most ? e : most;
  }
};
} // namespace run_kernel
using namespace run_kernel;

/// The scratch of a tile, and its displacements.
template <int Dim> struct RunScratch {
  const RunView<Dim>& view;
  const double* u;
  Index owned;

  template <int W> PDX_INLINE void fill(const RunTile& begin, const RunTile& end) const
  {
    for (std::size_t k = begin.particles; k < end.particles; ++k) load_particles<W>(view.particles[k]);
    const Index* const rows = view.rows.data() + begin.rows;
    for (std::size_t k = begin.points; k < end.points; ++k) interpolate<W>(view.points[k], rows);
  }
  PDX_INLINE void mark_counted(const RunParticles& some) const
  {
    for (Index l = 0; l < kRunBlock; ++l) *displacement(some.at + l, 2 * Dim) = 0.0;
    for_each_row(some, [&](Index row, Index place) { *displacement(place, 2 * Dim) = row < owned; });
  }

  template <class Visit> PDX_INLINE void for_each_row(const RunParticles& some, Visit visit) const
  {
    for (Index l = 0; l < kRunBlock; ++l) {
      const Index row = some.row >= 0 ? some.row + l : view.particle_rows[some.rows + l];
      if (row >= 0) visit(row, some.at + l);
    }
  }

  PDX_INLINE double* displacement(Index place, int d) const
  {
    return view.scratch + place + static_cast<std::ptrdiff_t>(d) * view.pitch;
  }
  PDX_INLINE double* force(Index place, int d) const { return displacement(place, Dim + d); }

private:
  template <int W> PDX_INLINE void load_particles(const RunParticles& some) const
  {
    if (Dim == 2 && some.row >= 0) {
      for (int l = 0; l < kRunBlock; l += W) {
        Lanes<W> x[2];
        part<W>(u + static_cast<std::ptrdiff_t>(some.row + l) * 2, x);
        for (int d = 0; d < 2; ++d) store<W>(x[d], displacement(some.at + l, d));
      }
      return;
    }
    for_each_row(some, [&](Index row, Index place) {
      for (int d = 0; d < Dim; ++d) *displacement(place, d) = u[static_cast<std::ptrdiff_t>(row) * Dim + d];
    });
  }

  template <int W> PDX_INLINE void interpolate(const RunPoints& some, const Index* rows) const
  {
    for (int l = 0; l < kRunBlock; l += W) {
      Lanes<W> x[Dim] = {};
      for (Index h = 0; h < some.hosts; ++h) {
        const double* const host = u + static_cast<std::ptrdiff_t>(rows[view.hosts[some.host + h]]) * Dim;
        const Lanes<W> weight = load<W>(view.weights + some.weights + h * kRunBlock + l);
        for (int d = 0; d < Dim; ++d) x[d] += weight * host[d];
      }
      for (int d = 0; d < Dim; ++d) store<W>(x[d], displacement(some.at + l, d));
    }
  }
};

/// e = |xi + eta|^2 / |xi|^2 - 1 as a sum of small terms, so that small stretches keep their digits.
template <int Dim> struct SweepRuns {
  const RunView<Dim>& view;
  RunScratch<Dim> in;
  bool finite;
  double* r;
  bool& passed;

  template <int W> PDX_INLINE void run() const
  {
    typename Simd<W>::Mask over{};
    RunTile from;
    for (std::size_t t = 0; t < view.tiles.size(); ++t) {
      const RunTile to = view.tiles[t];
      in.template fill<W>(from, to);
      sweep_tile<W>(from, to, view.far[t], over);
      for (std::size_t k = from.particles; k < to.particles; ++k) unload_particles<W>(view.particles[k]);
      for (std::size_t k = from.points; k < to.points; ++k) hand_on<W>(view.points[k]);
      fold<W>(view.rows.data() + from.rows, to.rows - from.rows);
      from = to;
    }
    passed = any_true(over);
  }

private:
  template <int W> PDX_INLINE void unload_particles(const RunParticles& some) const
  {
    if (Dim == 2 && some.row >= 0)
      for (int l = 0; l < kRunBlock; l += W) {
        Lanes<W> x[2];
        for (int d = 0; d < 2; ++d) x[d] = load<W>(in.force(some.at + l, d));
        join_onto<W>(r + static_cast<std::ptrdiff_t>(some.row + l) * 2, x);
      }
    else
      in.for_each_row(some, [&](Index row, Index place) {
        if (row < in.owned)
          for (int d = 0; d < Dim; ++d) r[static_cast<std::ptrdiff_t>(row) * Dim + d] += *in.force(place, d);
      });
    clear<W>(some.at);
  }

  template <int W> PDX_INLINE void hand_on(const RunPoints& some) const
  {
    for (int l = 0; l < kRunBlock; l += W) {
      Lanes<W> x[Dim];
      for (int d = 0; d < Dim; ++d) x[d] = load<W>(in.force(some.at + l, d));
      for (Index h = 0; h < some.hosts; ++h) {
        double* const sum = view.sums + static_cast<std::ptrdiff_t>(view.hosts[some.host + h]) * Dim * kRunBlock;
        const Lanes<W> weight = load<W>(view.weights + some.weights + h * kRunBlock + l);
        for (int d = 0; d < Dim; ++d) store<W>(load<W>(sum + d * W) + weight * x[d], sum + d * W);
      }
    }
    clear<W>(some.at);
  }

  template <int W> PDX_INLINE void fold(const Index* rows, std::size_t count) const
  {
    for (std::size_t k = 0; k < count; ++k)
      for (int d = 0; d < Dim; ++d) {
        double* const sum = view.sums + k * Dim * kRunBlock + d * W;
        if (rows[k] < in.owned) r[static_cast<std::ptrdiff_t>(rows[k]) * Dim + d] += folded<W>(load<W>(sum));
        store<W>(Lanes<W>{}, sum);
      }
  }

  template <int W> PDX_INLINE void clear(Index at) const
  {
    for (int l = 0; l < kRunBlock; l += W)
      for (int d = 0; d < Dim; ++d) store<W>(Lanes<W>{}, in.force(at + l, d));
  }

  /// Begins with the way of the last time. Where that turns out to be another than the bonds need, the forces are added
  /// up again: they depend on the state alone, to the last bit, and not on how it was reached.
  template <int W>
  PDX_INLINE void sweep_tile(const RunTile& begin, const RunTile& end, std::uint8_t& far,
                             typename Simd<W>::Mask& over) const
  {
    if (!finite) {
      sweep_all<W, Growth::linear>(begin, end, over);
      return;
    }
    for (;;) {
      const bool needed =
          far ? sweep_all<W, Growth::far>(begin, end, over) : sweep_all<W, Growth::near>(begin, end, over);
      if (needed == (far != 0)) return;
      far = needed;
      for (std::size_t k = begin.particles; k < end.particles; ++k) clear<W>(view.particles[k].at);
      for (std::size_t k = begin.points; k < end.points; ++k) clear<W>(view.points[k].at);
    }
  }

  /// @return is any bond far from its length?
  template <int W, Growth growth>
  PDX_INLINE bool sweep_all(const RunTile& begin, const RunTile& end, typename Simd<W>::Mask& over) const
  {
    Extremes<W> all;
    for (std::size_t k = begin.runs; k < end.runs; ++k) {
      const Extremes<W> seen = sweep<W, growth>(view.runs[k]);
      over |= seen.most > view.runs[k].limit;
      all.see(seen.most);
      all.see(seen.least);
    }
    return any_true((all.most > kNear) | (all.least < -kNear));
  }

  template <int W, Growth growth> PDX_INLINE Extremes<W> sweep(const Run<Dim>& one) const
  {
    constexpr bool turned = growth != Growth::linear;
    const Run<Dim> bonds = one; // what is stored could lie anywhere, for all that the compiler knows
    const double* const stiffnesses = view.stiffness + bonds.stiffness;
    double* const from = in.displacement(bonds.from, 0);
    double* const to = in.displacement(bonds.to, 0);
    const std::ptrdiff_t pitch = view.pitch;
    Extremes<W> seen;
    for (std::ptrdiff_t k = 0; k < bonds.blocks * kRunBlock; k += W) {
      const Lanes<W> stiffness = load<W>(stiffnesses + k);
      Lanes<W> y[Dim], e{};
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) {
        const Lanes<W> eta = load<W>(to + k + d * pitch) - load<W>(from + k + d * pitch);
        y[d] = turned ? bonds.xi[d] + eta : Lanes<W>{} + bonds.xi[d];
        e += (turned ? bonds.xi[d] + y[d] : y[d]) * eta;
      }
      e = stiffness != 0.0 ? e * bonds.per_square : Lanes<W>{};
      seen.see(e);
      const Lanes<W> pull = stiffness * shortened<W, growth>(e);
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) {
        const Lanes<W> f = pull * y[d];
        const std::ptrdiff_t at = k + (Dim + d) * pitch;
        store<W>(load<W>(from + at) - f, from + at);
        store<W>(load<W>(to + at) + f, to + at);
      }
    }
    return seen;
  }
};

/// 1/2 kappa |xi| s^2 of each bond, s = e / (1 + sqrt(1 + e)).
template <int Dim> struct SumRunEnergy {
  const RunView<Dim>& view;
  RunScratch<Dim> in;
  bool finite;
  double& energy;

  template <int W> PDX_INLINE void run() const
  {
    Lanes<W> all{};
    RunTile from;
    for (const RunTile& to : view.tiles) {
      in.template fill<W>(from, to);
      for (std::size_t k = from.particles; k < to.particles; ++k) in.mark_counted(view.particles[k]);
      for (std::size_t k = from.runs; k < to.runs; ++k) all += of_run<W>(view.runs[k]);
      from = to;
    }
    energy = folded<W>(all);
  }

private:
  template <int W> PDX_INLINE Lanes<W> of_run(const Run<Dim>& bonds) const
  {
    Lanes<W> all{};
    for (int k = 0; k < bonds.blocks * kRunBlock; k += W) {
      const Lanes<W> stiffness = load<W>(view.stiffness + bonds.stiffness + k);
      Lanes<W> s{};
      for (int d = 0; d < Dim; ++d) {
        const Lanes<W> eta = load<W>(in.displacement(bonds.to + k, d)) - load<W>(in.displacement(bonds.from + k, d));
        s += (finite ? 2.0 * bonds.xi[d] + eta : Lanes<W>{} + bonds.xi[d]) * eta;
      }
      s = stiffness != 0.0 ? s * bonds.per_square : Lanes<W>{};
      if (finite) s /= 1.0 + square_root<W>(1.0 + s);
      all += stiffness * s * s * load<W>(in.displacement(bonds.from + k, 2 * Dim));
    }
    return 0.5 / bonds.per_square * all;
  }
};

template <int Dim>
bool add_run_forces(Processor processor, const RunView<Dim>& view, bool finite, const double* u, Index owned, double* r)
{
  bool passed = false;
  run_on(processor, SweepRuns<Dim>{view, {view, u, owned}, finite, r, passed});
  return passed;
}

template <int Dim>
double run_energy(Processor processor, const RunView<Dim>& view, bool finite, const double* u, Index owned)
{
  double energy = 0.0;
  run_on(processor, SumRunEnergy<Dim>{view, {view, u, owned}, finite, energy});
  return energy;
}

template bool add_run_forces<2>(Processor, const RunView<2>&, bool, const double*, Index, double*);
template bool add_run_forces<3>(Processor, const RunView<3>&, bool, const double*, Index, double*);
template double run_energy<2>(Processor, const RunView<2>&, bool, const double*, Index);
template double run_energy<3>(Processor, const RunView<3>&, bool, const double*, Index);
} // namespace pdx::couple
