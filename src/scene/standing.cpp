#include "pdx/scene/standing.hpp"

#include "pdx/scene/cloud_body.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/solid.hpp"

namespace pdx::scene {
Standing::Standing(mesh::Mesh* background, const Solid* space) : mesh(background), solid(space), model(space) {}
Standing::Standing(mesh::Mesh* background, CloudModel* particles) : mesh(background), cloud(particles), model(particles)
{}
Standing::Standing(mesh::Mesh* background, const PointModel* material_points)
    : mesh(background), points(material_points), model(material_points)
{}
} // namespace pdx::scene
