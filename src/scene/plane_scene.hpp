#pragma once
#include "pdx/scene/scene.hpp"
#include "pdx/solve/stable_step.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::scene {
/// A mesh, cut by measured costs if there are any.
inline mesh::Mesh cut_mesh(MPI_Comm comm, const mesh::MeshOptions& options, const mesh::CellCost& cost,
                           const mesh::MeasuredCosts* costs)
{
  return costs ? mesh::build_by_costs(comm, options, *costs) : mesh::build(comm, options, cost);
}

/// The papers' step of the material with the least.
template <int Dim> double papers_step(const pd::Stencil<Dim>& stencil, const law::Regions* regions)
{
  double least = 1.0;
  for (std::size_t k = 1; regions && k < regions->count(); ++k)
    least = std::min(least,
                     std::sqrt(regions->elastic(k).density / regions->elastic(0).density / regions->stiffness(k, k)));
  return least * pd::papers_step(stencil);
}

/// Elements, patches and perhaps bodies of points in the plane, in time. Collective.
/// @param points null without such bodies
std::unique_ptr<Scene> plane_scene(MPI_Comm comm, options::SceneOptions options, const mesh::MeasuredCosts* costs,
                                   std::shared_ptr<const PointPlan<2>> points);
} // namespace pdx::scene
