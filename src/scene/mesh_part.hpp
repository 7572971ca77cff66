#pragma once
#include "pdx/scene/discretisation.hpp"

namespace pdx::scene {
/// The mesh of a scene in the plane: its nodes and enriched sets, elements and cut elements. Both outlive it.
std::unique_ptr<Part> mesh_part(const mesh::Mesh& mesh, const Discretisation& d);
} // namespace pdx::scene
