#pragma once
#include "pdx/base/symmetric.hpp"
#include "pdx/solve/stable_step.hpp"

#include <algorithm>

namespace pdx::test {
/// Replaces the sets of an owned displacement (u, a) by the far half's w = u + factor a, or the other way round.
///@{
inline void to_tied(const std::vector<field::Tie>& ties, std::vector<double>& d)
{
  for (const field::Tie& tie : ties)
    for (int k = 0; k < 2; ++k) {
      double& w = d[static_cast<std::size_t>(2 * tie.set + k)];
      w = d[static_cast<std::size_t>(2 * tie.row + k)] + tie.factor * w;
    }
}
inline void from_tied(const std::vector<field::Tie>& ties, std::vector<double>& d)
{
  for (const field::Tie& tie : ties)
    for (int k = 0; k < 2; ++k) {
      double& a = d[static_cast<std::size_t>(2 * tie.set + k)];
      a = (a - d[static_cast<std::size_t>(2 * tie.row + k)]) / tie.factor;
    }
}
///@}

/// 2 / omega_max of a linear system on one rank, from all its frequencies [s].
inline double true_limit(const field::System& system)
{
  const auto size = static_cast<std::size_t>(2 * system.rows.owned());
  const std::vector<double> mass = solve::lumped_mass(system);
  const std::vector<field::Tie> ties = solve::ties_of(system);
  std::vector<std::size_t> free; // a set may be held only together with its node
  for (std::size_t c = 0; c < size; ++c)
    if (!system.held[c]) free.push_back(c);
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd k(n, n);
  for (std::size_t j = 0; j < free.size(); ++j) {
    std::vector<double> d(size, 0.0), force(size, 0.0);
    d[free[j]] = 1.0 / std::sqrt(mass[free[j] / 2]);
    from_tied(ties, d);
    for (const auto& term : system.terms) term->add_residual(d, force);
    for (const field::Tie& tie : ties)
      for (int c = 0; c < 2; ++c) {
        double& of_set = force[static_cast<std::size_t>(2 * tie.set + c)];
        of_set /= tie.factor;
        force[static_cast<std::size_t>(2 * tie.row + c)] -= of_set;
      }
    for (std::size_t i = 0; i < free.size(); ++i)
      k(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = force[free[i]] / std::sqrt(mass[free[i] / 2]);
  }
  return 2.0 / std::sqrt(symmetric_eigenvalues(k)[n - 1]);
}
} // namespace pdx::test
