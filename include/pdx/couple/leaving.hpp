#pragma once
#include "pdx/base/tensor.hpp"

namespace pdx::couple {
/// Where a bond from a particle leaves its patch, counted in spacings.
struct Leaving {
  Index side = -1;    ///< number of the straight side in its patch; -1: none is known
  Index depth = 0;    ///< rows of particles between the side and the particle
  Index place = 0;    ///< of the particle along the side, from its lower end
  double along = 0.0; ///< from there along the side to where the bond meets it [-]
};
} // namespace pdx::couple
