#pragma once
#include "support/scene.hpp"

#include <algorithm>
#include <span>

namespace pdx::test {
struct Strain {
  const char* name;
  Field field;
};
inline const Strain kStrains[] = {{"e_xx", affine(1e-3, 0.0, 0.0, 0.0)},
                                  {"e_yy", affine(0.0, 0.0, 0.0, 1e-3)},
                                  {"gamma_xy", affine(0.0, 5e-4, 5e-4, 0.0)},
                                  {"all", affine(1e-3, 7e-4, 2e-4, -8e-4, {3e-4, -2e-4})}};

/// Largest error of a uniform strain imposed on the outer boundary, over some strains.
inline double worst_error(const options::SceneOptions& options, std::span<const Strain> strains = kStrains)
{
  const Option tight("-ksp_rtol", "1e-13");
  Scene scene(options);
  double worst = 0.0;
  for (const Strain& strain : strains) {
    scene.prescribe(strain.field);
    worst = std::max(worst, scene.max_error(scene.solve().get(), strain.field));
  }
  return worst;
}

/// The unit square pulled along x between held ends; bottom and perhaps top are free.
inline options::SceneOptions bar(bool free_top)
{
  auto options = held_plate({16, 16});
  std::erase_if(options.conditions, [&](const auto& c) { return c.on == "bottom" || (free_top && c.on == "top"); });
  return options;
}

inline double tension_error(const options::SceneOptions& options)
{
  const Option tight("-ksp_rtol", "1e-13");
  const Field tension = affine(1e-3, 0.0, 0.0, -1e-3 / 3.0, {2e-4, 1e-4});
  Scene scene(options);
  scene.prescribe(tension);
  return scene.max_error(scene.solve().get(), tension);
}
} // namespace pdx::test
