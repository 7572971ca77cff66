#include "pdx/solve/stable_step.hpp"

#include "pdx/base/gather.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace pdx::solve {
namespace {
constexpr double kAlike = 1e-9; // of limits that differ by rounding only

/// 1 per owned component that cannot move, in tied displacements: w moves unless both node and set are held.
std::vector<std::uint8_t> tied_held(const field::System& system)
{
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  std::vector<std::uint8_t> held(
      system.held.begin(), system.held.begin() + static_cast<std::ptrdiff_t>(system.rows.owned()) * system.rows.dim);
  for (const field::Tie& tie : ties_of(system))
    for (std::size_t d = 0; d < dim; ++d)
      held[static_cast<std::size_t>(tie.set) * dim + d] &= held[static_cast<std::size_t>(tie.row) * dim + d];
  return held;
}

/// Largest eigenvalue of the symmetric block over the components that are not held.
template <int Dim> double largest_free(const double* block, const std::uint8_t* held)
{
  Tensor<Dim> free;
  for (int a = 0; a < Dim; ++a)
    for (int b = 0; b < Dim; ++b) free(a, b) = held[a] || held[b] ? 0.0 : block[a * Dim + b];
  return Eigen::SelfAdjointEigenSolver<Tensor<Dim>>(free, Eigen::EigenvaluesOnly).eigenvalues()[Dim - 1];
}

struct Bounds {
  std::vector<double> mass;      ///< [kg]
  std::vector<double> stiffness; ///< lambda_max(D_i) [N/m]

  double step(std::size_t row) const
  {
    return stiffness[row] > 0.0 ? 2.0 * std::sqrt(mass[row] / stiffness[row]) : std::numeric_limits<double>::infinity();
  }
};

Bounds bounds_of(const field::System& system)
{
  const auto owned = static_cast<std::size_t>(system.rows.owned()), dim = static_cast<std::size_t>(system.rows.dim);
  std::vector<double> blocks(owned * dim * dim, 0.0);
  for (const auto& term : system.terms) term->add_stiffness_bound(blocks);
  const std::vector<std::uint8_t> held = tied_held(system);
  Bounds bounds{lumped_mass(system), std::vector<double>(owned)};
  for (std::size_t row = 0; row < owned; ++row) {
    const double* block = blocks.data() + row * dim * dim;
    const std::uint8_t* fixed = held.data() + row * dim;
    bounds.stiffness[row] = dim == 2 ? largest_free<2>(block, fixed) : largest_free<3>(block, fixed);
  }
  return bounds;
}

/// Of the owned rows with a step up to `limit`, the one at the lowest place.
std::vector<StableStep> lowest(const field::System& system, const Bounds& bounds, double limit)
{
  std::vector<StableStep> found;
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  for (std::size_t row = 0; row < bounds.mass.size(); ++row) {
    if (!(bounds.step(row) <= limit)) continue;
    StableStep here{bounds.step(row), system.rows.first + static_cast<PetscInt>(row), {}};
    std::copy_n(system.coordinates.begin() + static_cast<std::ptrdiff_t>(row * dim), dim, here.place.begin());
    if (found.empty() || here.place < found.front().place) found.assign(1, here);
  }
  return found;
}
} // namespace

std::vector<double> lumped_mass(const field::System& system)
{
  std::vector<double> mass(static_cast<std::size_t>(system.rows.owned()), 0.0);
  for (const auto& term : system.terms) term->add_mass(mass);
  return mass;
}

std::vector<field::Tie> ties_of(const field::System& system)
{
  std::vector<field::Tie> ties;
  for (const auto& term : system.terms) term->ties(ties);
  return ties;
}

StableStep stable_step(const field::System& system)
{
  const Bounds bounds = bounds_of(system);
  double limit = std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < bounds.mass.size(); ++row) limit = std::min(limit, bounds.step(row));
  MPI_Allreduce(MPI_IN_PLACE, &limit, 1, MPI_DOUBLE, MPI_MIN, system.rows.comm);
  if (std::isinf(limit)) return {limit, -1, {}};
  const auto all = gather_all(system.rows.comm, lowest(system, bounds, limit * (1.0 + kAlike)));
  StableStep first = *std::ranges::min_element(all, {}, &StableStep::place);
  if (limit == 0.0)
    throw SolverFailure(
        fmt::format("the material at ({:g}) has stiffness but no mass, so that no explicit step is "
                    "stable: give a density above 0",
                    fmt::join(std::span(first.place).first(static_cast<std::size_t>(system.rows.dim)), ", ")));
  first.limit = limit;
  return first;
}
} // namespace pdx::solve
