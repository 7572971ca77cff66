#pragma once
#include "pdx/adapt/fill.hpp"

namespace pdx::adapt {
/// Particles that a change takes away, on the rank of the element that takes their place.
struct Leaving {
  std::vector<Index> cells;                ///< local cell of each
  std::vector<Vector<2>> places;           ///< [m]
  std::vector<std::vector<double>> fields; ///< two components for each
};

/// @param fields local blocks [owned | halo] of the scene as it stands
Leaving leaving(const SceneView& scene, std::span<const geom::Box<2>> uncovered,
                std::span<const std::span<const double>> fields);

/// Enriched rows that there may be once cracks have gone on, at rest: of owned vertices around the elements to come,
/// and of those around elements that are cut already.
/// @param fields as many as rows have
FreshRows fresh_sets(const SceneView& scene, const LayoutChange& change, std::size_t fields);

/// Corrects rows at cracks that are new by what makes the elements carry the particles that left as nearly as can be,
/// by least squares with all other rows given, and by no more than that needs [XPD2 Eqs. 17-21]: those of sets, and of
/// nodes of cut elements that have no set there. Collective.
/// @param scene  the new one   @param is_new  owned rows
/// @param fields owned rows of the new scene, two components each, in the order of those that left
void fit_sets(const SceneView& scene, const Leaving& left, std::span<const Index> is_new,
              std::span<const std::span<double>> fields);
} // namespace pdx::adapt
