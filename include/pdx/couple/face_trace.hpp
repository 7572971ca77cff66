#pragma once
#include "pdx/couple/space_shape.hpp"
#include "pdx/couple/surroundings.hpp"
#include "pdx/pd/stencil.hpp"

namespace pdx::couple {
/// How a point of a face between particles and points hangs on the four nodes of the face, besides by their hats. A
/// displacement that is y z on a face, the product that hats have, is met by bonds in few places of each lattice cell,
/// and the mean of these is not its own: at uniform shear a corner of the particles keeps a force. So the product is
/// y z + share `face_bubble`, which is nothing on the lines of the lattice, so that faces still meet, and nothing for
/// what is linear; all shears, which are alike on a cubic lattice, are then handed on exactly by particles of any
/// shape.
/// @return the share [-]; 0 where no bond meets a face off those lines
double face_share(const pd::Stencil<3>& stencil);

/// @param y, z from the middle of a lattice cell's face, in spacings    [spacings^2]
inline double face_bubble(double y, double z) { return y * z * (1.0 - 4.0 * y * y) * (1.0 - 4.0 * z * z); }

/// What carries a place in which a bond leaves the particles: the nodes of the face of points there, as they carry
/// points, and by `face_bubble`. Bonds that cross faces of grid cells then hand any uniform strain on as a uniform
/// traction: each lattice cell is crossed alike by what its mirror images are. Within `zone` lattice cells of a free
/// side, where the tension of corrected bonds is uniform in sum and moment only, the trace of the face across the side
/// is averaged over these cells, mean and slope. Empty where `beyond` has no points.
/// @param x in spacings from the body's corner   @param inner, beyond  the lattice cells before and after it on the
/// bond
std::optional<Host> face_host(const SpaceShape& shape, const NodeRows& rows, Index zone, const Vector<3>& x,
                              const Site<3>& inner, const Site<3>& beyond);
} // namespace pdx::couple
