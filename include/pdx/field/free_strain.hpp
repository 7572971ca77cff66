#pragma once
#include "pdx/base/tensor.hpp"

#include <functional>

namespace pdx::field {
/// Strain in the plane that the material takes on by itself where nothing holds it, alike in all directions (heat):
/// by place [m], without unit. Stress and energy are of what strain there is beyond it.
using FreeStrain = std::function<double(const Vector<2>& x)>;

/// Free strain along a path of loads.
struct Swelling {
  std::function<FreeStrain(double load)> at_load;
  FreeStrain now = [](const Vector<2>&) { return 0.0; }; ///< where the Terms are
};
} // namespace pdx::field
