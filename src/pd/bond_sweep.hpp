#pragma once
#include "lanes.hpp"
#include "pdx/pd/bond_kernel.hpp"

#include <algorithm>

namespace pdx::pd {
/// One directed bond i -> j of eight neighbouring particles.
template <int Dim> struct BondLanes {
  std::ptrdiff_t i, j;  ///< window index of the first particle and of its neighbour
  double xi[Dim];       ///< from i to j  [m]
  double length, kappa; ///< [m], [N]
};

/// The weight w of eight bonds that are all there with factor 1.
struct AllThere {
  PDX_INLINE Lanes operator()(Lanes x) const { return x; }
};
/// The weight w of bonds that may be missing; those give 0 even for an x that is not finite.
struct WhereIntact {
  MaskLanes intact;
  PDX_INLINE Lanes operator()(Lanes x) const { return intact ? x : Lanes{}; }
};
/// As WhereIntact, times the surface factor.
struct WhereIntactScaled {
  MaskLanes intact;
  Lanes factor;
  PDX_INLINE Lanes operator()(Lanes x) const { return intact ? x * factor : Lanes{}; }
};

enum class Weighting { none, bits, bits_and_share };

/// Adds the eight bonds of half arm h in the direction of `sign` (+1 or -1); `lower` is their lower end.
template <Weighting weighting, int Dim, class Op>
PDX_INLINE void add_bonds(const BondView<Dim>& view, std::size_t h, std::ptrdiff_t i, int sign, const Op& op,
                          Lanes (&sum)[Op::kRows])
{
  const HalfArm<Dim>& arm = view.arms[h];
  BondLanes<Dim> bond{i, i + sign * arm.jump, {}, arm.length, arm.kappa};
  for (int d = 0; d < Dim; ++d) bond.xi[d] = sign * arm.xi[d];
  if constexpr (weighting == Weighting::none) {
    op.add(view, bond, AllThere{}, sum);
  } else {
    const std::ptrdiff_t lower = sign > 0 ? i : bond.j;
    const MaskLanes intact = (load(view.words[h / 64] + lower) & (std::uint64_t{1} << h % 64)) != 0;
    if constexpr (weighting == Weighting::bits)
      op.add(view, bond, WhereIntact{intact}, sum);
    else
      op.add(view, bond, WhereIntactScaled{intact, 2.0 / (load(view.share + i) + load(view.share + bond.j))}, sum);
  }
}

template <Weighting weighting, int Dim, class Op>
PDX_INLINE void sweep_run(const BondView<Dim>& view, const Run& run, const Op& op, double* out)
{
  for (Index k = 0; k < run.length; k += kLanes) {
    Lanes sum[Op::kRows] = {};
    for (std::size_t h = 0; h < view.arms.size(); ++h)
      for (const int sign : {1, -1}) add_bonds<weighting>(view, h, run.at + k, sign, op, sum);
    add_rows(sum, run.length - k, out + static_cast<std::ptrdiff_t>(run.row + k) * Op::kRows);
  }
}

/// Partial runs, and whole ones where the kernel has no faster way for them.
template <int Dim, class Op>
PDX_INLINE void sweep_partial(const BondView<Dim>& view, const Run& run, const Op& op, double* out)
{
  if (view.share)
    sweep_run<Weighting::bits_and_share>(view, run, op, out);
  else
    sweep_run<Weighting::bits>(view, run, op, out);
}

/// Adds op over all bonds of all particles of the runs to rows of Op::kRows. An Op has
/// `add(view, bond, weight, sum)`, where weight(x) is w x.
template <int Dim, class Op>
PDX_INLINE void sweep(const BondView<Dim>& view, std::span<const Run> runs, const Op& op, double* out)
{
  for (const Run& run : runs)
    if (run.kind == RunKind::whole)
      sweep_run<Weighting::none>(view, run, op, out);
    else
      sweep_partial(view, run, op, out);
}
} // namespace pdx::pd
