#include "pdx/pd/csr_kernel.hpp"

// Compiled without contraction to FMA: either end of a bond comes to the same judgement.
namespace pdx::pd {
template <int Dim>
std::vector<std::int64_t> break_csr_bonds(const CsrView<Dim>& view, const BreakRule& rule, const double* u,
                                          std::uint8_t* intact)
{
  const bool linear = rule.kinematics == Kinematics::small;
  const double s0 = rule.critical_stretch, factor = linear ? s0 : s0 * (2.0 + s0);
  std::vector<std::int64_t> broken;
  for (std::size_t i = 0; i + 1 < view.first.size(); ++i)
    for (std::int64_t b = view.first[i]; b < view.first[i + 1]; ++b) {
      const auto j = static_cast<std::size_t>(view.neighbour[b]);
      if (!intact[b] || (rule.no_fail && (rule.no_fail[i] || rule.no_fail[j]))) continue;
      double growth = 0.0;
      for (std::size_t d = 0; d < Dim; ++d) {
        const double xi = view.points[j * Dim + d] - view.points[i * Dim + d], eta = u[j * Dim + d] - u[i * Dim + d];
        growth += linear ? xi * eta : (2.0 * xi + eta) * eta;
      }
      if (!(growth > factor * view.length[b] * view.length[b])) continue;
      intact[b] = 0;
      broken.push_back(b);
    }
  return broken;
}

template std::vector<std::int64_t> break_csr_bonds<2>(const CsrView<2>&, const BreakRule&, const double*,
                                                      std::uint8_t*);
template std::vector<std::int64_t> break_csr_bonds<3>(const CsrView<3>&, const BreakRule&, const double*,
                                                      std::uint8_t*);
} // namespace pdx::pd
