#pragma once
#include "pdx/mpm/body.hpp"
#include "pdx/options/point_options.hpp"

namespace pdx::scene {
/// Where the skin of a body is, half a spacing within the border of its shape: of discs, spheres, polygons and regions
/// of a mesh. Empty for what ends with its sites: boxes and points of a file. Sides along z are left as they are.
/// @param inside is a place in the shape?
template <int Dim>
std::function<Vector<Dim>(const Vector<Dim>& site, unsigned uncovered)>
skin_of(const options::PointShape& shape, double spacing, std::function<bool(const Vector<2>&)> inside);
} // namespace pdx::scene
