#include "pdx/pd/csr_part.hpp"

#include "pdx/base/error.hpp"
#include "pdx/law/bond_force.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::pd {
namespace {
constexpr double kRounding = 1e-9; // of lengths over particle sizes, as for lattices

template <int Dim> double size_of(double volume, double thickness)
{
  return Dim == 2 ? std::sqrt(volume / thickness) : std::cbrt(volume);
}

/// Points sorted into cubes, to find those near a point among 3^Dim cubes.
template <int Dim> class CellGrid {
public:
  CellGrid(const std::vector<Vector<Dim>>& points, double side) : side_(side)
  {
    lower_ = points.front();
    Vector<Dim> upper = points.front();
    for (const Vector<Dim>& x : points) {
      lower_ = lower_.cwiseMin(x).eval();
      upper = upper.cwiseMax(x).eval();
    }
    std::size_t cells = 1;
    double budget = 4.0 * static_cast<double>(points.size()) + 64.0; // cubes; wider ones where the cloud is thin
    for (double total = 1.0;; side_ *= 1.5, total = 1.0) {
      for (int d = 0; d < Dim; ++d) total *= std::floor((upper[d] - lower_[d]) / side_) + 1.0;
      if (total <= budget) break;
    }
    for (int d = 0; d < Dim; ++d) {
      count_[d] = static_cast<Index>((upper[d] - lower_[d]) / side_) + 1;
      cells *= static_cast<std::size_t>(count_[d]);
    }
    first_.assign(cells + 1, 0);
    for (const Vector<Dim>& x : points) ++first_[number(cell(x)) + 1];
    for (std::size_t c = 0; c < cells; ++c) first_[c + 1] += first_[c];
    order_.resize(points.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t k = 0; k < points.size(); ++k) order_[next[number(cell(points[k]))]++] = static_cast<Index>(k);
  }

  /// All points less than a cube's side away from x, and others, in ascending order.
  void near(const Vector<Dim>& x, std::vector<Index>& found) const
  {
    found.clear();
    const Site<Dim> centre = cell(x);
    constexpr int cubes = Dim == 2 ? 9 : 27;
    for (int cube = 0; cube < cubes; ++cube) {
      Site<Dim> at = centre;
      bool inside = true;
      for (std::size_t d = 0, digits = static_cast<std::size_t>(cube); d < Dim; ++d, digits /= 3) {
        at[d] += static_cast<Index>(digits % 3) - 1;
        inside &= at[d] >= 0 && at[d] < count_[d];
      }
      if (!inside) continue;
      const auto begin = order_.begin();
      found.insert(found.end(), begin + static_cast<std::ptrdiff_t>(first_[number(at)]),
                   begin + static_cast<std::ptrdiff_t>(first_[number(at) + 1]));
    }
    std::sort(found.begin(), found.end());
  }

private:
  Site<Dim> cell(const Vector<Dim>& x) const
  {
    Site<Dim> at{};
    for (int d = 0; d < Dim; ++d)
      at[static_cast<std::size_t>(d)] =
          std::clamp(static_cast<Index>((x[d] - lower_[d]) / side_), Index{0}, count_[static_cast<std::size_t>(d)] - 1);
    return at;
  }
  std::size_t number(const Site<Dim>& at) const
  {
    std::size_t n = 0;
    for (std::size_t d = Dim; d-- > 0;) n = n * static_cast<std::size_t>(count_[d]) + static_cast<std::size_t>(at[d]);
    return n;
  }

  double side_;
  Vector<Dim> lower_;
  Site<Dim> count_{};
  std::vector<std::size_t> first_;
  std::vector<Index> order_;
};
} // namespace

template <int Dim>
CsrPart<Dim>::CsrPart(const Cloud<Dim>& cloud, Index owned, const CloudOptions& options)
    : options_(options), law_(options.micromodulus, options.elastic, options.horizon)
{
  if (Dim == 2 && options.thickness != options.elastic.thickness)
    throw UserError(fmt::format("the particles are {:g} m thick but the material is {:g} m thick; give one thickness",
                                options.thickness, options.elastic.thickness));
  for (const Vector<Dim>& x : cloud.points) points_.insert(points_.end(), x.begin(), x.end());
  if (cloud.points.empty()) return;
  const double largest = *std::max_element(cloud.volumes.begin(), cloud.volumes.end());
  const CellGrid<Dim> grid(cloud.points, options.horizon + size_of<Dim>(largest, options.thickness));
  std::vector<Index> near;
  for (Index i = 0; i < owned; ++i) {
    grid.near(cloud.points[static_cast<std::size_t>(i)], near);
    add_bonds_of(i, cloud, near);
  }
  intact_.assign(neighbour_.size(), 1);
  if (owned > 1 && neighbour_.empty())
    throw UserError(fmt::format("particles: no two of them are within the horizon of {:g} m", options.horizon));
}

template <int Dim> double CsrPart<Dim>::share(double length, double volume) const
{
  const double size = size_of<Dim>(volume, options_.thickness), beyond = (length - options_.horizon) / size;
  const bool conical = options_.micromodulus == law::Micromodulus::conical;
  if (beyond > (conical ? -kRounding : 0.5 - kRounding)) return 0.0;
  return std::clamp(0.5 - beyond, 0.0, 1.0);
}

template <int Dim> double CsrPart<Dim>::kappa(double length, double volume_i, double volume_j) const
{
  return law_.constant(length) * 0.5 * (share(length, volume_i) + share(length, volume_j)) * volume_i * volume_j;
}

template <int Dim> void CsrPart<Dim>::add_bonds_of(Index i, const Cloud<Dim>& cloud, std::span<const Index> near)
{
  const auto at = static_cast<std::size_t>(i);
  for (const Index j : near) {
    if (j == i) continue;
    const auto to = static_cast<std::size_t>(j);
    const double length = (cloud.points[to] - cloud.points[at]).norm();
    if (length == 0.0)
      throw UserError(fmt::format("particles: two of them are in one place, ({})",
                                  fmt::format("{:g}, {:g}", cloud.points[at][0], cloud.points[at][1])));
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
  return add_gathered_force<Dim>(chosen_processor(), view(), kinematics, critical_stretch, u.data(), r.data(), energy);
}

template <int Dim> Broken CsrPart<Dim>::break_bonds(const BreakRule& rule, std::span<const double> u)
{
  Broken broken;
  for (const std::int64_t bond : break_csr_bonds<Dim>(view(), rule, u.data(), intact_.data())) {
    const auto b = static_cast<std::size_t>(bond);
    const auto i = std::upper_bound(first_.begin(), first_.end(), bond) - first_.begin() - 1;
    const std::ptrdiff_t j = neighbour_[b];
    const double *x = points_.data() + i * Dim, *y = points_.data() + j * Dim;
    if (!std::lexicographical_compare(x, x + Dim, y, y + Dim)) continue;
    const Eigen::Map<const Vector<Dim>> at(x), to(y), ui(u.data() + i * Dim), uj(u.data() + j * Dim);
    const Vector<Dim> xi = to - at, eta = uj - ui;
    const double stretch = rule.kinematics == Kinematics::finite ? law::finite_state<Dim>(xi, length_[b], eta).stretch
                                                                 : law::linear_state<Dim>(xi, length_[b], eta).stretch;
    ++broken.bonds;
    broken.energy += law::bond_energy(weight_[b] * length_[b], length_[b], stretch);
  }
  return broken;
}

template class CsrPart<2>;
template class CsrPart<3>;
} // namespace pdx::pd
