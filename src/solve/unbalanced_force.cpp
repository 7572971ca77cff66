#include "pdx/solve/static_driver.hpp"

namespace pdx::solve {
std::vector<double> unbalanced_force(const field::System& system, std::span<const double> owned, double load,
                                     std::vector<double>& local)
{
  system.halo->fetch(owned, system.rows.dim, local);
  std::vector<double> r(system.load.size());
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = -load * system.load[k];
  for (const auto& term : system.terms) term->add_residual(local, r);
  return r;
}
} // namespace pdx::solve
