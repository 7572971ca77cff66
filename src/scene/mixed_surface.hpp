#pragma once
#include "pdx/couple/contact_term.hpp"
#include "pdx/scene/discretisation.hpp"

namespace pdx::scene {
/// Points at the surface of the bodies of a mixed scene, of this rank: material points, particles and, along the border
/// of the mesh, elements.
std::vector<couple::SurfacePoint<2>> surface_points(const mesh::Mesh& mesh, const Discretisation& d);
} // namespace pdx::scene
