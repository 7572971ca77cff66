#include "pdx/pd/csr_part.hpp"

#include "pdx/geom/cell_grid.hpp"
#include "pdx/law/bond_force.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::pd {
namespace {
constexpr double kOnePlace = 1e-4; // of a particle's size
constexpr double kRounding = 1e-6; // of lengths over particle sizes: three sizes lie on a horizon of three

template <int Dim>
void require_apart(const Cloud<Dim>& cloud, double thickness, std::span<const Index> numbers, std::array<Index, 2> pair)
{
  const auto at = [](Index k) { return static_cast<std::size_t>(k); };
  const double length = (cloud.points[at(pair[1])] - cloud.points[at(pair[0])]).norm();
  if (length >= kOnePlace * particle_size<Dim>(cloud.volumes[at(pair[0])], thickness)) return;
  if (!numbers.empty()) pair = {numbers[at(pair[0])], numbers[at(pair[1])]};
  throw UserError(fmt::format("particles: numbers {} and {} are in one place, {:g} m apart: take one of them out",
                              std::min(pair[0], pair[1]) + 1, std::max(pair[0], pair[1]) + 1, length));
}
} // namespace

template <int Dim> double particle_size(double volume, double thickness)
{
  return Dim == 2 ? std::sqrt(volume / thickness) : std::cbrt(volume);
}
template double particle_size<2>(double, double);
template double particle_size<3>(double, double);

template <int Dim> double bond_reach(const CloudOptions& options, double largest_volume)
{
  const bool conical = options.micromodulus == law::Micromodulus::conical; // no force where it ends
  const double beyond = conical ? 0.0 : 0.5 * particle_size<Dim>(largest_volume, options.thickness);
  return (options.horizon + beyond) * (1.0 + kRounding);
}
template double bond_reach<2>(const CloudOptions&, double);
template double bond_reach<3>(const CloudOptions&, double);

UserError no_neighbours(double horizon)
{
  return UserError(fmt::format("particles: no two of them are within the horizon of {:g} m", horizon));
}

template <int Dim>
CsrPart<Dim>::CsrPart(const Cloud<Dim>& cloud, Index owned, const CloudOptions& options, std::span<const Index> numbers)
    : options_(options), law_(options.micromodulus, options.elastic, options.horizon), volumes_(cloud.volumes)
{
  if (Dim == 2 && options.thickness != options.elastic.thickness)
    throw UserError(fmt::format("the particles are {:g} m thick but the material is {:g} m thick; give one thickness",
                                options.thickness, options.elastic.thickness));
  for (const Vector<Dim>& x : cloud.points) points_.insert(points_.end(), x.begin(), x.end());
  if (cloud.points.empty()) return;
  const double largest = *std::max_element(cloud.volumes.begin(), cloud.volumes.end());
  const geom::CellGrid<Dim> grid(cloud.points, bond_reach<Dim>(options, largest));
  std::vector<Index> near;
  for (Index i = 0; i < owned; ++i) {
    grid.near(cloud.points[static_cast<std::size_t>(i)], near);
    if (!numbers.empty()) std::ranges::sort(near, {}, [&](Index j) { return numbers[static_cast<std::size_t>(j)]; });
    for (const Index j : near)
      if (j != i) require_apart<Dim>(cloud, options.thickness, numbers, {i, j});
    add_bonds_of(i, cloud, near);
  }
  intact_.assign(neighbour_.size(), 1);
  if (owned > 1 && static_cast<std::size_t>(owned) == cloud.points.size() && neighbour_.empty())
    throw no_neighbours(options.horizon);
}

template <int Dim> double CsrPart<Dim>::share(double length, double volume) const
{
  const double size = particle_size<Dim>(volume, options_.thickness), beyond = (length - options_.horizon) / size;
  const bool conical = options_.micromodulus == law::Micromodulus::conical;
  if (beyond > (conical ? -kRounding : 0.5 - kRounding)) return 0.0;
  return std::clamp(0.5 - beyond, 0.0, 1.0);
}

template <int Dim> double CsrPart<Dim>::kappa(double length, double volume_i, double volume_j) const
{
  return law_.constant(length) * 0.5 * (share(length, volume_i) + share(length, volume_j)) * (volume_i * volume_j);
}

template <int Dim> void CsrPart<Dim>::add_bonds_of(Index i, const Cloud<Dim>& cloud, std::span<const Index> near)
{
  const auto at = static_cast<std::size_t>(i);
  for (const Index j : near) {
    if (j == i) continue;
    const auto to = static_cast<std::size_t>(j);
    const double length = (cloud.points[to] - cloud.points[at]).norm();
    const double stiffness = kappa(length, cloud.volumes[at], cloud.volumes[to]);
    if (!(stiffness > 0.0)) continue;
    neighbour_.push_back(j);
    length_.push_back(length);
    weight_.push_back(stiffness / length);
  }
  first_.push_back(static_cast<std::int64_t>(neighbour_.size()));
}

template <int Dim> CsrView<Dim> CsrPart<Dim>::view() const
{
  return {first_, neighbour_.data(), intact_.data(), length_.data(), weight_.data(), points_.data()};
}

template <int Dim> std::int64_t CsrPart<Dim>::bonds() const
{
  return std::count(intact_.begin(), intact_.end(), std::uint8_t{1});
}

template <int Dim>
CsrSeen CsrPart<Dim>::add_force(Kinematics kinematics, double critical_stretch, std::span<const double> u,
                                std::span<double> r, bool energy) const
{
  return add_gathered_force<Dim>(processor_, view(), kinematics, critical_stretch, u.data(), r.data(), energy);
}

template <int Dim> bool CsrPart<Dim>::counts(std::size_t i, std::size_t j) const
{
  const double *x = points_.data() + i * Dim, *y = points_.data() + j * Dim;
  return std::lexicographical_compare(x, x + Dim, y, y + Dim);
}

template <int Dim>
Broken CsrPart<Dim>::break_bonds(const BreakRule& rule, std::span<const double> u, field::ForceLosses* losses)
{
  Broken broken;
  for (const std::int64_t bond : break_csr_bonds<Dim>(view(), rule, u.data(), intact_.data())) {
    const auto b = static_cast<std::size_t>(bond), j = static_cast<std::size_t>(neighbour_[b]);
    const auto i = static_cast<std::size_t>(std::ranges::upper_bound(first_, bond) - first_.begin() - 1);
    using Place = Eigen::Map<const Vector<Dim>>;
    const Vector<Dim> xi = Place(points_.data() + j * Dim) - Place(points_.data() + i * Dim),
                      eta = Place(u.data() + j * Dim) - Place(u.data() + i * Dim);
    const law::BondState<Dim> state = rule.kinematics == Kinematics::finite
                                          ? law::finite_state<Dim>(xi, length_[b], eta)
                                          : law::linear_state<Dim>(xi, length_[b], eta);
    const double kappa = weight_[b] * length_[b];
    for (int d = 0; losses && d < Dim; ++d)
      losses->push_back({static_cast<Index>(i) * Dim + d, -kappa * state.stretch * state.direction[d]});
    if (!counts(i, j)) continue;
    ++broken.bonds;
    broken.energy += law::bond_energy(kappa, length_[b], state.stretch);
  }
  return broken;
}

template <int Dim> std::int64_t CsrPart<Dim>::cut(const crack::CrackSet& cracks)
{
  std::int64_t count = 0;
  const double longest = length_.empty() ? 0.0 : *std::ranges::max_element(length_);
  const auto in_plane = [&](std::size_t i) { return Vector<2>(points_[i * Dim], points_[i * Dim + 1]); };
  for (std::size_t i = 0; i + 1 < first_.size(); ++i) {
    if (!cracks.near(in_plane(i), longest)) continue;
    for (auto b = static_cast<std::size_t>(first_[i]); b < static_cast<std::size_t>(first_[i + 1]); ++b) {
      const auto j = static_cast<std::size_t>(neighbour_[b]);
      if (!intact_[b] || !cracks.cuts(in_plane(i), in_plane(j))) continue;
      intact_[b] = 0;
      count += counts(i, j);
    }
  }
  return count;
}

template <int Dim> void CsrPart<Dim>::keep_only(std::span<const std::uint8_t> intact)
{
  for (std::size_t b = 0; b < intact_.size(); ++b) intact_[b] &= intact[b];
}

template <int Dim> std::vector<double> CsrPart<Dim>::bonded_volume() const
{
  std::vector<double> sums;
  for (std::size_t i = 0; i + 1 < first_.size(); ++i) {
    sums.push_back(0.0);
    for (auto b = static_cast<std::size_t>(first_[i]); b < static_cast<std::size_t>(first_[i + 1]); ++b)
      if (intact_[b]) sums.back() += weight_[b] * length_[b] / (law_.constant(length_[b]) * volumes_[i]);
  }
  return sums;
}

template class CsrPart<2>;
template class CsrPart<3>;
} // namespace pdx::pd
