#pragma once
#include "pdx/scene/discretisation.hpp"

namespace pdx::scene {
struct Solid;
struct CloudModel;
struct PointModel;

/// The scene a run is about, once it stands: in the plane, in space, a cloud or material points in either. All that is
/// pointed to lives until another scene takes its place.
struct Standing {
  Standing() = default;
  Standing(mesh::Mesh* background, const PatchPlan* patches, const Discretisation* plane)
      : mesh(background), plan(patches), d(plane), model(plane)
  {}
  Standing(mesh::Mesh* background, const Solid* space);
  Standing(mesh::Mesh* background, CloudModel* particles);
  Standing(mesh::Mesh* background, const PointModel* material_points);

  mesh::Mesh* mesh = nullptr;
  const PatchPlan* plan = nullptr;    ///< null in space and of a cloud
  const Discretisation* d = nullptr;  ///< likewise
  const Solid* solid = nullptr;       ///< null in the plane and of a cloud
  CloudModel* cloud = nullptr;        ///< of a cloud only
  const PointModel* points = nullptr; ///< of material points only
  const Model* model = nullptr;       ///< what d, solid or cloud is
};
} // namespace pdx::scene
