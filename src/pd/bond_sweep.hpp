#pragma once
#include "pdx/base/lanes.hpp"
#include "pdx/pd/bond_kernel.hpp"

#include <algorithm>

namespace pdx::pd {
/// One directed bond i -> j of W neighbouring particles.
template <int Dim> struct BondLanes {
  std::ptrdiff_t i, j;  ///< window index of the first particle and of its neighbour
  double xi[Dim];       ///< from i to j  [m]
  double length, kappa; ///< [m], [N]
};

/// The weight w of W bonds that are all there with factor 1.
template <int W> struct AllThere {
  PDX_INLINE Lanes<W> operator()(Lanes<W> x) const { return x; }
};
/// The weight w of bonds that may be missing; those give 0 even for an x that is not finite.
template <int W> struct WhereIntact {
  typename Simd<W>::Mask intact;
  PDX_INLINE Lanes<W> operator()(Lanes<W> x) const { return intact ? x : Lanes<W>{}; }
};
/// As WhereIntact, times the surface factor.
template <int W> struct WhereIntactScaled {
  typename Simd<W>::Mask intact;
  Lanes<W> factor;
  PDX_INLINE Lanes<W> operator()(Lanes<W> x) const { return intact ? x * factor : Lanes<W>{}; }
};

/// Surface factors of the W bonds along half arm h that start at sites lower, lower + 1 ...
template <int W, int Dim> PDX_INLINE Lanes<W> factors_at(const BondView<Dim>& view, std::size_t h, std::ptrdiff_t lower)
{
  Lanes<W> factor;
  for (int l = 0; l < W; ++l) factor[l] = view.factors[view.classes[lower + l] * view.arms.size() + h];
  return factor;
}

enum class Weighting { none, bits, bits_and_factors };

/// Adds the W bonds of half arm h in the direction of `sign` (+1 or -1); `lower` is their lower end.
template <int W, Weighting weighting, int Dim, class Op>
PDX_INLINE void add_bonds(const BondView<Dim>& view, std::size_t h, std::ptrdiff_t i, int sign, const Op& op,
                          Lanes<W> (&sum)[Op::kRows])
{
  const HalfArm<Dim>& arm = view.arms[h];
  BondLanes<Dim> bond{i, i + sign * arm.jump, {}, arm.length, arm.kappa};
  for (int d = 0; d < Dim; ++d) bond.xi[d] = sign * arm.xi[d];
  if constexpr (weighting == Weighting::none) {
    op.template add<W>(view, bond, AllThere<W>{}, sum);
  } else {
    const std::ptrdiff_t lower = sign > 0 ? i : bond.j;
    const typename Simd<W>::Mask intact = (load<W>(view.words[h / 64] + lower) & (std::uint64_t{1} << h % 64)) != 0;
    if constexpr (weighting == Weighting::bits)
      op.template add<W>(view, bond, WhereIntact<W>{intact}, sum);
    else
      op.template add<W>(view, bond, WhereIntactScaled<W>{intact, factors_at<W>(view, h, lower)}, sum);
  }
}

template <int W, Weighting weighting, int Dim, class Op>
PDX_INLINE void sweep_run(const BondView<Dim>& view, const Run& run, const Op& op, double* out)
{
  for (Index k = 0; k < run.length; k += W) {
    Lanes<W> sum[Op::kRows] = {};
    for (std::size_t h = 0; h < view.arms.size(); ++h)
      for (const int sign : {1, -1}) add_bonds<W, weighting>(view, h, run.at + k, sign, op, sum);
    add_rows<W>(sum, run.length - k, out + static_cast<std::ptrdiff_t>(run.row + k) * Op::kRows);
  }
}

/// Partial runs, and whole ones where the kernel has no faster way for them.
template <int W, int Dim, class Op>
PDX_INLINE void sweep_partial(const BondView<Dim>& view, const Run& run, const Op& op, double* out)
{
  if (view.classes)
    sweep_run<W, Weighting::bits_and_factors>(view, run, op, out);
  else
    sweep_run<W, Weighting::bits>(view, run, op, out);
}

/// Adds op over all bonds of all particles of the runs to rows of Op::kRows, in the version for this processor. An Op
/// has `add<W>(view, bond, weight, sum)`, where weight(x) is w x.
template <int Dim, class Op> struct Sweep {
  const BondView<Dim>& view;
  std::span<const Run> runs;
  const Op& op;
  double* out;
  template <int W> PDX_INLINE void run() const
  {
    for (const Run& run : runs)
      if (run.kind == RunKind::whole)
        sweep_run<W, Weighting::none>(view, run, op, out);
      else
        sweep_partial<W>(view, run, op, out);
  }
};
template <int Dim, class Op> void sweep(const BondView<Dim>& view, std::span<const Run> runs, const Op& op, double* out)
{
  run_here(Sweep<Dim, Op>{view, runs, op, out});
}
} // namespace pdx::pd
