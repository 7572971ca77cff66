#pragma once
#include <vector>

namespace pdx::field {
/// What moves between two steps, owned rows * dim each: values, not views.
struct State {
  std::vector<double> u;     ///< [m]
  std::vector<double> v;     ///< [m/s]
  std::vector<double> a;     ///< [m/s^2]
  std::vector<double> held;  ///< internal force where something is held, 0 elsewhere [N]
  std::vector<double> inner; ///< of what moves by steps of its own, see `OwnSteps`: owned rows * its width
};
} // namespace pdx::field
