#pragma once
#include "pdx/app/point_options.hpp"
#include "pdx/mpm/body.hpp"

namespace pdx::app {
/// The body that fills a shape with points. Throws UserError for sides that are no whole numbers of the spacing, for no
/// point, and for a file of points that lie on no lattice of that spacing.
/// @param frame of the shape; a file's points are moved into it
template <int Dim>
mpm::Body<Dim> body_of(const PointBodyOptions& options, const mpm::BodyMaterial& material, const geom::Frame& frame);

/// Around the points of a file [m].
template <int Dim> geom::Box<3> around_file(const PointBodyOptions& options);
} // namespace pdx::app
