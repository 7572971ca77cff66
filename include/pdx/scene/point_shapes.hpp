#pragma once
#include "pdx/mpm/body.hpp"
#include "pdx/options/point_options.hpp"

namespace pdx::scene {
/// The body that fills a shape with points. Throws UserError for sides that are no whole numbers of the spacing, for no
/// point, and for a file of points that lie on no lattice of that spacing.
/// @param frame of the shape; a file's points are moved into it
template <int Dim>
mpm::Body<Dim> body_of(const options::PointBodyOptions& options, const mpm::BodyMaterial& material,
                       const geom::Frame& frame);

/// Around the points of a file [m].
template <int Dim> geom::Box<3> around_file(const options::PointBodyOptions& options);
} // namespace pdx::scene
