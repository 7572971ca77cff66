#include "pdx/pd/csr_kernel.hpp"

#include "pdx/base/lanes.hpp"

#include <cmath>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace pdx::pd {
namespace {
constexpr double kRoom = 1e-12; // for rounding in the search for overstretched bonds

double limit_of(Kinematics kinematics, double s0)
{
  return (kinematics == Kinematics::small ? s0 : s0 * (2.0 + s0)) * (1.0 - kRoom);
}

/// One bond or W: kappa s / |y| for finite, kappa s / |xi| for linear stretch, and what of it gives the energy.
template <Kinematics kinematics, class Number> struct Pull {
  Number pull, stretch;
  template <class Root>
  PDX_INLINE Pull(Number growth, Number square, Number length, Number weight, bool energy, Root root)
      : pull(), stretch()
  {
    if constexpr (kinematics == Kinematics::finite) {
      const Number deformed = square + growth, mean = length * root(deformed);
      pull = weight * growth / (deformed + mean);
      if (energy) stretch = growth / (square + mean);
    } else {
      pull = weight * growth / square;
      if (energy) stretch = growth / square;
    }
  }
};

template <int Dim, Kinematics kinematics, bool energetic>
CsrSeen sweep_bonds(const CsrView<Dim>& view, double limit, const double* u, double* r)
{
  CsrSeen seen;
  for (std::size_t i = 0; i + 1 < view.first.size(); ++i) {
    const double *x = view.points + i * Dim, *v = u + i * Dim;
    double sum[Dim] = {};
    for (std::int64_t b = view.first[i]; b < view.first[i + 1]; ++b) {
      if (!view.intact[b]) continue;
      const std::ptrdiff_t j = std::ptrdiff_t{view.neighbour[b]} * Dim;
      double arrow[Dim], growth = 0.0;
      for (int d = 0; d < Dim; ++d) {
        const double xi = view.points[j + d] - x[d], eta = u[j + d] - v[d];
        arrow[d] = kinematics == Kinematics::finite ? xi + eta : xi;
        growth += kinematics == Kinematics::finite ? (2.0 * xi + eta) * eta : xi * eta;
      }
      const double length = view.length[b], square = length * length;
      if (growth > limit * square) seen.overstretched = true;
      const Pull<kinematics, double> bond(growth, square, length, view.weight[b], energetic,
                                          [](double q) { return std::sqrt(q); });
      if constexpr (energetic) seen.energy += 0.25 * view.weight[b] * square * bond.stretch * bond.stretch;
      for (int d = 0; d < Dim; ++d) sum[d] += bond.pull * arrow[d];
    }
    for (int d = 0; d < Dim; ++d) r[i * Dim + static_cast<std::size_t>(d)] -= sum[d];
  }
  return seen;
}

/// x[index[l]] for all lanes.
template <int W> PDX_INLINE Lanes<W> gather(const double* x, const std::int32_t* index)
{
  Lanes<W> values;
  for (int l = 0; l < W; ++l) values[l] = x[index[l]];
  return values;
}
#if defined(__x86_64__)
template <>
__attribute__((target("arch=x86-64-v4"))) inline Lanes<8> gather<8>(const double* x, const std::int32_t* index)
{
  const __m256i at = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(index));
  return _mm512_mask_i32gather_pd(_mm512_setzero_pd(), __mmask8{0xff}, at, x, 8); // the plain one warns in g++ 12
}
#endif

/// W bonds of one particle; lanes past its last bond repeat the particle itself with weight 0.
template <int W> struct Batch {
  alignas(64) std::int32_t at[W]; ///< first component of j
  Lanes<W> length, weight;

  template <int Dim> PDX_INLINE Batch(const CsrView<Dim>& view, std::size_t i, std::int64_t b, std::int64_t end)
  {
    if (b + W <= end) {
      for (int l = 0; l < W; ++l) at[l] = view.neighbour[b + l] * Dim;
      length = load<W>(view.length + b);
      typename Simd<W>::Words intact;
      for (int l = 0; l < W; ++l) intact[l] = view.intact[b + l];
      weight = intact != 0 ? load<W>(view.weight + b) : Lanes<W>{};
      return;
    }
    for (int l = 0; l < W; ++l) {
      const bool there = b + l < end;
      at[l] = there ? view.neighbour[b + l] * Dim : static_cast<std::int32_t>(i) * Dim;
      length[l] = there ? view.length[b + l] : 1.0;
      weight[l] = there && view.intact[b + l] ? view.weight[b + l] : 0.0;
    }
  }
};

template <int Dim, Kinematics kinematics, bool energetic> struct GatherBonds {
  const CsrView<Dim>& view;
  double limit;
  const double* u;
  double* r;
  CsrSeen& seen;

  template <int W> PDX_INLINE void run() const
  {
    Lanes<W> excess{}, energy{};
    for (std::size_t i = 0; i + 1 < view.first.size(); ++i) {
      Lanes<W> sum[Dim] = {};
      for (std::int64_t b = view.first[i]; b < view.first[i + 1]; b += W) {
        const Batch<W> batch(view, i, b, view.first[i + 1]);
        Lanes<W> arrow[Dim], growth{};
        for (int d = 0; d < Dim; ++d) {
          const Lanes<W> xi = gather<W>(view.points + d, batch.at) - view.points[i * Dim + static_cast<std::size_t>(d)];
          const Lanes<W> eta = gather<W>(u + d, batch.at) - u[i * Dim + static_cast<std::size_t>(d)];
          arrow[d] = kinematics == Kinematics::finite ? xi + eta : xi;
          growth += kinematics == Kinematics::finite ? (2.0 * xi + eta) * eta : xi * eta;
        }
        const Lanes<W> square = batch.length * batch.length;
        const Lanes<W> over = batch.weight > 0.0 ? growth - limit * square : Lanes<W>{};
        excess = over > excess ? over : excess;
        const Pull<kinematics, Lanes<W>> bond(
            growth, square, batch.length, batch.weight, energetic,
            [](Lanes<W> q) __attribute__((always_inline)) { return square_root<W>(q); });
        if constexpr (energetic) energy += 0.25 * batch.weight * square * bond.stretch * bond.stretch;
        for (int d = 0; d < Dim; ++d) sum[d] += bond.pull * arrow[d];
      }
      for (int d = 0; d < Dim; ++d)
        for (int l = 0; l < W; ++l) r[i * Dim + static_cast<std::size_t>(d)] -= sum[d][l];
    }
    for (int l = 0; l < W; ++l) {
      seen.overstretched |= excess[l] > 0.0;
      seen.energy += energy[l];
    }
  }
};

template <int Dim, Kinematics kinematics>
CsrSeen gather_bonds(Processor processor, const CsrView<Dim>& view, double limit, const double* u, double* r,
                     bool energy)
{
  CsrSeen seen;
  if (energy)
    run_on(processor, GatherBonds<Dim, kinematics, true>{view, limit, u, r, seen});
  else
    run_on(processor, GatherBonds<Dim, kinematics, false>{view, limit, u, r, seen});
  return seen;
}
} // namespace

template <int Dim>
CsrSeen add_csr_force(const CsrView<Dim>& view, Kinematics kinematics, double critical_stretch, const double* u,
                      double* r, bool energy)
{
  const double limit = limit_of(kinematics, critical_stretch);
  if (kinematics == Kinematics::small)
    return energy ? sweep_bonds<Dim, Kinematics::small, true>(view, limit, u, r)
                  : sweep_bonds<Dim, Kinematics::small, false>(view, limit, u, r);
  return energy ? sweep_bonds<Dim, Kinematics::finite, true>(view, limit, u, r)
                : sweep_bonds<Dim, Kinematics::finite, false>(view, limit, u, r);
}

template <int Dim>
CsrSeen add_gathered_force(Processor processor, const CsrView<Dim>& view, Kinematics kinematics,
                           double critical_stretch, const double* u, double* r, bool energy)
{
  const double limit = limit_of(kinematics, critical_stretch);
  return kinematics == Kinematics::small ? gather_bonds<Dim, Kinematics::small>(processor, view, limit, u, r, energy)
                                         : gather_bonds<Dim, Kinematics::finite>(processor, view, limit, u, r, energy);
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template CsrSeen add_csr_force<Dim>(const CsrView<Dim>&, Kinematics, double, const double*, double*, bool);          \
  template CsrSeen add_gathered_force<Dim>(Processor, const CsrView<Dim>&, Kinematics, double, const double*, double*, \
                                           bool)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::pd
