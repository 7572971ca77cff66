#include "pdx/couple/contact_touch.hpp"

#include "pdx/geom/nearest.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::couple {
namespace {
constexpr double kAlike = 1e-9; // what differs by rounding

template <int Dim> using Facet = typename ContactSkin<Dim>::Facet;

template <int Dim> const Vector<Dim>& corner(const Facet<Dim>& facet, std::span<const Vector<Dim>> x, std::size_t k)
{
  return x[static_cast<std::size_t>(facet.points[k])];
}

/// How well a normal stands upright on a facet; 0 if that is no face [-].
template <int Dim>
double uprightness(const Facet<Dim>& facet, std::span<const Vector<Dim>> x, const Vector<Dim>& normal)
{
  if (facet.count < Dim) return 0.0;
  const Vector<Dim> along = corner<Dim>(facet, x, 1) - corner<Dim>(facet, x, 0);
  if constexpr (Dim == 2)
    return std::abs(along.x() * normal.y() - along.y() * normal.x()) / along.norm();
  else
    return std::abs(along.cross(corner<3>(facet, x, 2) - corner<3>(facet, x, 0)).normalized().dot(normal));
}

template <int Dim>
std::array<double, Dim> nearest(const Facet<Dim>& facet, std::span<const Vector<Dim>> x, const Vector<Dim>& to)
{
  std::array<double, Dim> weights{1.0};
  if (facet.count == 2) {
    const auto [a, b] = geom::nearest_on_segment<Dim>(corner<Dim>(facet, x, 0), corner<Dim>(facet, x, 1), to);
    weights[0] = a;
    weights[1] = b;
  }
  if constexpr (Dim == 3)
    if (facet.count == 3)
      weights = geom::nearest_on_triangle(corner<3>(facet, x, 0), corner<3>(facet, x, 1), corner<3>(facet, x, 2), to);
  return weights;
}
/// Squares of lengths [m^2].
struct Reach {
  double nearest = std::numeric_limits<double>::infinity(); ///< from a place to the nearest corner
  double longest = 0.0;                                     ///< edge
};

template <int Dim> Reach reach_to(const Facet<Dim>& facet, std::span<const Vector<Dim>> x, const Vector<Dim>& place)
{
  Reach reach;
  for (std::size_t j = 0; j < static_cast<std::size_t>(facet.count); ++j) {
    reach.nearest = std::min(reach.nearest, (corner<Dim>(facet, x, j) - place).squaredNorm());
    for (std::size_t k = 0; k < j; ++k)
      reach.longest = std::max(reach.longest, (corner<Dim>(facet, x, j) - corner<Dim>(facet, x, k)).squaredNorm());
  }
  return reach;
}

template <int Dim>
Vector<Dim> from_place(const Facet<Dim>& facet, std::span<const Vector<Dim>> x, const std::array<double, Dim>& weights,
                       const Vector<Dim>& to)
{
  Vector<Dim> from = to;
  for (std::size_t k = 0; k < static_cast<std::size_t>(facet.count); ++k) from -= weights[k] * corner<Dim>(facet, x, k);
  return from;
}
} // namespace

template <int Dim>
double distance_to(const typename ContactSkin<Dim>::Facet& facet, std::span<const Vector<Dim>> x,
                   const Vector<Dim>& place)
{
  return from_place<Dim>(facet, x, nearest<Dim>(facet, x, place), place).norm();
}

template <int Dim>
Touch<Dim> deepest_touch(const ContactSkin<Dim>& skin, std::span<const Index> facets, std::span<const Vector<Dim>> x,
                         Index point, double less)
{
  Touch<Dim> deepest;
  const Vector<Dim>& at = x[static_cast<std::size_t>(point)];
  for (const Index number : facets) {
    const Facet<Dim>& facet = skin.facet(number);
    const double d0 = (1.0 - kTouching) * 0.5 * (skin.point(point).size + facet.size) - less;
    const double alike = kAlike * facet.size, torn = ContactSkin<Dim>::kTorn * facet.size;
    const double far = d0 - deepest.overlap + alike; // beyond, it is not as deep
    const Reach reach = reach_to<Dim>(facet, x, at);
    if (!(reach.nearest <= far * far + reach.longest / 3.0) || reach.longest > torn * torn) continue;
    const std::array<double, Dim> weights = nearest<Dim>(facet, x, at);
    const Vector<Dim> from = from_place<Dim>(facet, x, weights, at);
    const double distance = from.norm(), overlap = d0 - distance, more = overlap - deepest.overlap;
    if (!(overlap > 0.0) || !(more > -alike) || distance == 0.0) continue;
    const Vector<Dim> normal = from / distance;
    if (deepest.facet >= 0 && more <= alike &&
        uprightness<Dim>(facet, x, normal) <= uprightness<Dim>(skin.facet(deepest.facet), x, deepest.normal) + kAlike)
      continue;
    deepest = {number, weights, normal, distance, overlap};
  }
  return deepest;
}

template double distance_to<2>(const ContactSkin<2>::Facet&, std::span<const Vector<2>>, const Vector<2>&);
template double distance_to<3>(const ContactSkin<3>::Facet&, std::span<const Vector<3>>, const Vector<3>&);
template Touch<2> deepest_touch<2>(const ContactSkin<2>&, std::span<const Index>, std::span<const Vector<2>>, Index,
                                   double);
template Touch<3> deepest_touch<3>(const ContactSkin<3>&, std::span<const Index>, std::span<const Vector<3>>, Index,
                                   double);
} // namespace pdx::couple
