#pragma once
#include "pdx/law/regions.hpp"
#include "pdx/pd/surface.hpp"

#include <memory>

namespace pdx::pd {
/// Bonds of a body of several materials: the factor that surfaces give, times `law::Regions::stiffness` of the regions
/// of both ends. In space regions reach through the thickness.
/// @param surfaces may be empty
template <int Dim>
SurfaceCorrection<Dim> correct_regions(Stencil<Dim> stencil, std::shared_ptr<const law::Regions> regions,
                                       SurfaceCorrection<Dim> surfaces);
} // namespace pdx::pd
