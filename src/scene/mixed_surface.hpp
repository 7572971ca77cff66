#pragma once
#include "pdx/couple/contact_term.hpp"
#include "pdx/scene/discretisation.hpp"

namespace pdx::scene {
/// Points at the surface of the bodies of a mixed scene, of this rank: material points, particles and, along the border
/// of the mesh, elements. Collective.
/// @param by_sites of bodies of points: at their sites, as particles are, which they may become
std::vector<couple::SurfacePoint<2>> surface_points(const mesh::Mesh& mesh, const Discretisation& d, bool by_sites);
} // namespace pdx::scene
