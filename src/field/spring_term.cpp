#include "pdx/base/symmetric.hpp"
#include "pdx/field/support.hpp"

namespace pdx::field {
namespace {
constexpr double kNone = 1e-10; // of the stiffest direction of a row
}

void SpringTerm::resisting(std::vector<Resisting>& found) const
{
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const SymmetricModes modes = symmetric_modes(
        Eigen::Map<const Eigen::MatrixXd>(stiffness_.data() + k * static_cast<std::size_t>(dim_ * dim_), dim_, dim_));
    for (Eigen::Index mode = 0; mode < dim_; ++mode) {
      if (modes.values[mode] <= kNone * modes.values[dim_ - 1]) continue;
      Vector<3> along = Vector<3>::Zero();
      along.head(dim_) = modes.vectors.col(mode);
      found.push_back({rows_[k], along});
    }
  }
}

/// visit(component, K u there) [N]
template <class Visit> void SpringTerm::for_each_force(std::span<const double> u, Visit&& visit) const
{
  const auto dim = static_cast<std::size_t>(dim_);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    for (std::size_t a = 0; a < dim; ++a) {
      double force = 0.0;
      for (std::size_t b = 0; b < dim; ++b)
        force += stiffness_[(k * dim + a) * dim + b] * u[static_cast<std::size_t>(rows_[k]) * dim + b];
      visit(static_cast<std::size_t>(rows_[k]) * dim + a, force);
    }
}

Vector<3> SpringTerm::push(std::span<const double> u) const
{
  Vector<3> sum = Vector<3>::Zero();
  for_each_force(u, [&](std::size_t component, double force) {
    sum[static_cast<Eigen::Index>(component % static_cast<std::size_t>(dim_))] -= force;
  });
  return sum;
}

void SpringTerm::add_residual(std::span<const double> u, std::span<double> r) const
{
  for_each_force(u, [&](std::size_t component, double force) { r[component] += force; });
}

double SpringTerm::energy(std::span<const double> u) const
{
  double sum = 0.0;
  for_each_force(u, [&](std::size_t component, double force) { sum += 0.5 * force * u[component]; });
  return sum;
}

void SpringTerm::add_jacobian(BlockAdder& adder, bool) const
{
  const auto size = static_cast<std::size_t>(dim_ * dim_);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const std::span row(&rows_[k], 1);
    adder.add(row, row, std::span(stiffness_).subspan(k * size, size));
  }
}

void SpringTerm::add_stiffness_bound(std::span<double> blocks) const
{
  const auto size = static_cast<std::size_t>(dim_ * dim_);
  for (std::size_t k = 0; k < rows_.size(); ++k)
    for (std::size_t n = 0; n < size; ++n)
      blocks[static_cast<std::size_t>(rows_[k]) * size + n] += stiffness_[k * size + n];
}
} // namespace pdx::field
