#include "pdx/base/lanes.hpp"
#include "pdx/pd/strip_kernel.hpp"

namespace pdx::pd {
namespace {
/// As BreakSpans in breaker.cpp, lane by lane: linear: xi.eta > s0 |xi|^2; finite: 2 xi.eta + eta.eta > s0 (2 + s0)
/// |xi|^2. Both files are compiled without contraction to FMA.
template <int Dim, Kinematics kinematics> struct FindOverstretched {
  const StripView<Dim>& view;
  const StripBox& box;
  double critical_stretch;
  std::vector<StripBond>& bonds;

  template <int W> PDX_INLINE void run() const
  {
    for (int plane = 0; plane < box.planes; ++plane)
      for (int line = 0; line < box.lines; ++line) {
        const std::ptrdiff_t first = box.first + plane * box.plane + line * box.line;
        for (std::ptrdiff_t vector = first; vector < first + box.columns; ++vector) {
          typename Simd<W>::Mask any{};
          for (std::size_t h = 0; h < view.arms.size(); ++h) any |= over<W>(vector, h);
          for (int l = 0; l < W; ++l)
            if (any[l]) append<W>(vector, l);
        }
      }
  }

private:
  template <int W> PDX_INLINE typename Simd<W>::Mask over(std::ptrdiff_t vector, std::size_t h) const
  {
    const StripArm<Dim>& arm = view.arms[h];
    const double s0 = critical_stretch, factor = kinematics == Kinematics::small ? s0 : s0 * (2.0 + s0);
    const double* u = view.blocks + vector * (StripView<Dim>::kParts * W);
    Lanes<W> growth{};
    for (int d = 0; d < Dim; ++d) {
      const Lanes<W> eta = load<W>(u + arm.jump + d * W) - load<W>(u + d * W);
      if constexpr (kinematics == Kinematics::small)
        growth += arm.xi[static_cast<std::size_t>(d)] * eta;
      else
        growth += (2.0 * arm.xi[static_cast<std::size_t>(d)] + eta) * eta;
    }
    const typename Simd<W>::Mask intact = (load<W>(view.words[h / 64] + vector * W) & arm.bit) != 0;
    return (growth > factor * arm.length * arm.length) & intact;
  }

  template <int W> PDX_INLINE void append(std::ptrdiff_t vector, int lane) const
  {
    for (std::size_t h = 0; h < view.arms.size(); ++h)
      if (over<W>(vector, h)[lane]) bonds.push_back({vector, lane, static_cast<std::uint32_t>(h)});
  }
};
} // namespace

template <int Dim>
void find_overstretched(Processor processor, const StripView<Dim>& view, const StripBox& box, Kinematics kinematics,
                        double critical_stretch, std::vector<StripBond>& bonds)
{
  if (kinematics == Kinematics::small)
    run_on(processor, FindOverstretched<Dim, Kinematics::small>{view, box, critical_stretch, bonds});
  else
    run_on(processor, FindOverstretched<Dim, Kinematics::finite>{view, box, critical_stretch, bonds});
}

template void find_overstretched<2>(Processor, const StripView<2>&, const StripBox&, Kinematics, double,
                                    std::vector<StripBond>&);
template void find_overstretched<3>(Processor, const StripView<3>&, const StripBox&, Kinematics, double,
                                    std::vector<StripBond>&);
} // namespace pdx::pd
