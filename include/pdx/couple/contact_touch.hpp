#pragma once
#include "pdx/couple/contact_skin.hpp"

namespace pdx::couple {
/// How a point touches the skin of another body.
template <int Dim> struct Touch {
  Index facet = -1;                         ///< -1: it does not
  std::array<double, Dim> weights{};        ///< of the facet's points: the place of the skin that is touched
  Vector<Dim> normal = Vector<Dim>::Zero(); ///< from there to the point
  double distance = 0.0, overlap = 0.0;     ///< d, and d0 - d [m]
};

/// By this share of d0 points of different bodies may be nearer without a force, for rounding.
inline constexpr double kTouching = 1e-8;

/// From a place to the nearest of a facet [m].
/// @param x places of all points [m]
template <int Dim>
double distance_to(const typename ContactSkin<Dim>::Facet& facet, std::span<const Vector<Dim>> x,
                   const Vector<Dim>& place);

/// Where a point is deepest in the skin that these facets span. Of facets that meet there the one on which the normal
/// stands most upright counts, then the first, whatever rounding says.
/// @param x places of all points as they are now [m]   @param less taken off d0 [m]
template <int Dim>
Touch<Dim> deepest_touch(const ContactSkin<Dim>& skin, std::span<const Index> facets, std::span<const Vector<Dim>> x,
                         Index point, double less = 0.0);
} // namespace pdx::couple
