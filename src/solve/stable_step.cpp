#include "pdx/solve/stable_step.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/field/parted.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <memory>

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
template <int Dim> double largest_free(const Tensor<Dim>& free)
{
  return Eigen::SelfAdjointEigenSolver<Tensor<Dim>>(free, Eigen::EigenvaluesOnly).eigenvalues()[Dim - 1];
}

/// The same of one row after the other; alike blocks, of which lattices are full, are worked out once.
template <int Dim>
void largest_of_rows(std::span<const double> blocks, std::span<const std::uint8_t> held, std::span<double> stiffness)
{
  Tensor<Dim> before = Tensor<Dim>::Constant(std::numeric_limits<double>::quiet_NaN());
  double largest = 0.0;
  for (std::size_t row = 0; row < stiffness.size(); ++row) {
    const double* block = blocks.data() + row * Dim * Dim;
    const std::uint8_t* fixed = held.data() + row * Dim;
    Tensor<Dim> free;
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) free(a, b) = fixed[a] || fixed[b] ? 0.0 : block[a * Dim + b];
    if (free != before) largest = largest_free<Dim>(free);
    before = free;
    stiffness[row] = largest;
  }
}

struct Bounds {
  std::vector<double> mass;      ///< [kg]
  std::vector<double> stiffness; ///< lambda_max(D_i) [N/m]

  /// (step / 2)^2 [s^2]
  double square(std::size_t row) const
  {
    return stiffness[row] > 0.0 ? mass[row] / stiffness[row] : std::numeric_limits<double>::infinity();
  }
  double step(std::size_t row) const { return 2.0 * std::sqrt(square(row)); }
};

enum class Of : std::uint8_t { all, far };

void largest_of_rows(std::size_t dim, std::span<const double> blocks, std::span<const std::uint8_t> held,
                     std::span<double> stiffness)
{
  dim == 2 ? largest_of_rows<2>(blocks, held, stiffness) : largest_of_rows<3>(blocks, held, stiffness);
}

Bounds bounds_of(const field::System& system, Of what)
{
  const auto owned = static_cast<std::size_t>(system.rows.owned()), dim = static_cast<std::size_t>(system.rows.dim);
  std::vector<double> blocks(owned * dim * dim, 0.0);
  for (const auto& term : system.terms)
    if (what == Of::all)
      term->add_stiffness_bound(blocks);
    else if (const auto* parted = dynamic_cast<const field::Parted*>(term.get()))
      parted->add_far_bound(blocks);
  Bounds bounds{system.mass.empty() ? lumped_mass(system) : system.mass, std::vector<double>(owned)};
  largest_of_rows(dim, blocks, tied_held(system), bounds.stiffness);
  return bounds;
}

/// Room for values of all rows, of which some only are ever looked at: those are 0.
class SomeRows {
public:
  SomeRows(const field::System& system, field::RowRanges wanted, std::size_t components)
      : size_(static_cast<std::size_t>(system.rows.owned()) * components),
        values_(std::make_unique_for_overwrite<double[]>(size_)), components_(components)
  {
    for (const auto& range : wanted) std::ranges::fill(of(range), 0.0);
  }
  std::span<double> all() { return {values_.get(), size_}; }
  std::span<double> of(const std::array<Index, 2>& range)
  {
    return all().subspan(static_cast<std::size_t>(range[0]) * components_,
                         static_cast<std::size_t>(range[1] - range[0]) * components_);
  }

private:
  std::size_t size_;
  std::unique_ptr<double[]> values_;
  std::size_t components_;
};

/// Of the owned rows with a step up to `limit`, the one at the lowest place.
std::vector<StableStep> lowest(const field::System& system, const Bounds& bounds, double limit)
{
  std::vector<StableStep> found;
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  const double square = (1.0 + kAlike) * 0.25 * limit * limit; // roots are taken of few
  for (std::size_t row = 0; row < bounds.mass.size(); ++row) {
    if (!(bounds.square(row) <= square && bounds.step(row) <= limit)) continue;
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

void know_mass(field::System& system)
{
  if (!system.mass.empty()) return;
  system.mass = lumped_mass(system);
  system.inverse_mass.clear();
  system.inverse_mass.reserve(system.mass.size());
  for (const double m : system.mass) system.inverse_mass.push_back(1.0 / m);
}

void know_mass(field::System& system, field::RowRanges unknown)
{
  SomeRows mass(system, unknown, 1);
  for (const auto& term : system.terms) term->add_mass_in(unknown, mass.all());
  for (const auto& range : unknown)
    for (Index row = range[0]; row < range[1]; ++row) {
      const auto k = static_cast<std::size_t>(row);
      system.mass[k] = mass.all()[k];
      system.inverse_mass[k] = 1.0 / system.mass[k];
    }
}

std::vector<double> row_limits(field::System& system, field::RowRanges wanted)
{
  know_mass(system);
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  SomeRows blocks(system, wanted, dim * dim);
  for (const auto& term : system.terms) term->add_stiffness_bound_in(wanted, blocks.all());
  const std::vector<field::Tie> ties = ties_of(system);
  const std::vector<std::uint8_t> of_ties = ties.empty() ? std::vector<std::uint8_t>() : tied_held(system);
  const std::span<const std::uint8_t> held = ties.empty() ? std::span(system.held) : std::span(of_ties);
  std::vector<double> limits;
  for (const auto& range : wanted) {
    const auto first = static_cast<std::size_t>(range[0]), rows = static_cast<std::size_t>(range[1]) - first;
    Bounds bounds{{system.mass.begin() + range[0], system.mass.begin() + range[1]}, std::vector<double>(rows)};
    largest_of_rows(dim, blocks.of(range), held.subspan(first * dim, rows * dim), bounds.stiffness);
    for (std::size_t k = 0; k < rows; ++k) limits.push_back(bounds.square(k));
  }
  return limits;
}

namespace {
StableStep stable_step_of(const field::System& system, Of what)
{
  const Bounds bounds = bounds_of(system, what);
  double limit = std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < bounds.mass.size(); ++row) limit = std::min(limit, bounds.square(row));
  limit = 2.0 * std::sqrt(limit);
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
} // namespace

StableStep stable_step(const field::System& system) { return stable_step_of(system, Of::all); }
StableStep far_stable_step(const field::System& system) { return stable_step_of(system, Of::far); }
} // namespace pdx::solve
