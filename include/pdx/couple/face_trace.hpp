#pragma once
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
} // namespace pdx::couple
