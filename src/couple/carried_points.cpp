#include "pdx/couple/carried_points.hpp"

namespace pdx::couple {
template <int Dim> Index CarriedPoints<Dim>::add(const Host& host)
{
  for (std::size_t k = 0; k < static_cast<std::size_t>(host.count); ++k) {
    rows_.push_back(host.rows[k]);
    weights_.push_back(host.weights[k]);
    tied_.push_back(host.tied[k]);
  }
  offsets_.push_back(rows_.size());
  return size() - 1;
}

template <int Dim> std::span<const Index> CarriedPoints<Dim>::rows(Index point) const
{
  const auto p = static_cast<std::size_t>(point);
  return {rows_.data() + offsets_[p], offsets_[p + 1] - offsets_[p]};
}

template <int Dim> std::span<const double> CarriedPoints<Dim>::weights(Index point) const
{
  const auto p = static_cast<std::size_t>(point);
  return {weights_.data() + offsets_[p], offsets_[p + 1] - offsets_[p]};
}

template <int Dim> std::span<const double> CarriedPoints<Dim>::tied_weights(Index point) const
{
  const auto p = static_cast<std::size_t>(point);
  return {tied_.data() + offsets_[p], offsets_[p + 1] - offsets_[p]};
}

template <int Dim> void CarriedPoints<Dim>::bind(const field::RowHalo& halo)
{
  for (Index& row : rows_) row = halo.local(row);
}

template <int Dim> void CarriedPoints<Dim>::spread(std::span<const double> u, std::vector<double>& d) const
{
  d.assign(static_cast<std::size_t>(size()) * Dim, 0.0);
  for (std::size_t p = 0; p + 1 < offsets_.size(); ++p)
    for (std::size_t k = offsets_[p]; k < offsets_[p + 1]; ++k)
      for (std::size_t a = 0; a < Dim; ++a)
        d[p * Dim + a] += weights_[k] * u[static_cast<std::size_t>(rows_[k]) * Dim + a];
}

template <int Dim> Vector<Dim> CarriedPoints<Dim>::displacement(Index point, std::span<const double> u) const
{
  Vector<Dim> d = Vector<Dim>::Zero();
  for (std::size_t p = static_cast<std::size_t>(point), k = offsets_[p]; k < offsets_[p + 1]; ++k)
    d += weights_[k] * Eigen::Map<const Vector<Dim>>(&u[static_cast<std::size_t>(rows_[k]) * Dim]);
  return d;
}

template <int Dim>
void CarriedPoints<Dim>::add_force(Index point, const Vector<Dim>& force, Index owned_rows, std::span<double> f) const
{
  for (std::size_t p = static_cast<std::size_t>(point), k = offsets_[p]; k < offsets_[p + 1]; ++k)
    if (rows_[k] < owned_rows)
      Eigen::Map<Vector<Dim>>(&f[static_cast<std::size_t>(rows_[k]) * Dim]) += weights_[k] * force;
}

template class CarriedPoints<2>;
template class CarriedPoints<3>;
} // namespace pdx::couple
