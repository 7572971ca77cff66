#pragma once
#include "pdx/adapt/layout_change.hpp"
#include "pdx/adapt/scene_view.hpp"
#include "pdx/field/row_name.hpp"

namespace pdx::adapt {
/// Rows that another layout will have, with what they begin with. Each is named once on all ranks.
struct FreshRows {
  std::vector<field::RowName> names;
  std::vector<std::vector<double>> fields; ///< two components for each name
  void append(const FreshRows& more);      ///< of as many fields
};

/// The particles that elements become on this rank: each field as the element carries it there [XPD2 Eq. 14], bent by
/// the gradients at its nodes where no crack cuts it. Collective.
/// @param fields local blocks [owned | halo] of the scene as it stands
/// @param shapes patches that show how particles are named on the lattice of each cover: those to come, or those there
FreshRows fill_particles(const SceneView& scene, std::span<const LayoutChange::Cover> covers,
                         std::span<const couple::PatchShape> shapes, std::span<const std::span<const double>> fields);

/// The nodes of elements that take the place of particles: quadratics that fit best, in a moving least squares, the
/// particles within an element's side that no crack hides [XPD2 Eqs. 17-21, another weight]. Of owned vertices.
/// Collective.
FreshRows fill_nodes(const SceneView& scene, const LayoutChange& change,
                     std::span<const std::span<const double>> fields);

/// All rows that a change makes. Collective.
/// @param shapes as for `fill_particles`
FreshRows fill(const SceneView& scene, const LayoutChange& change, std::span<const couple::PatchShape> shapes,
               std::span<const std::span<const double>> fields);
} // namespace pdx::adapt
