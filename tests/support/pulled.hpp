#pragma once
#include "support/scene.hpp"

namespace pdx::test {
/// A dead load on a side [Pa].
inline options::BoundaryCondition pull(const char* side, const Vector<2>& traction)
{
  options::BoundaryCondition c;
  c.name = "pull";
  c.on = side;
  c.traction = Vector<3>(traction[0], traction[1], 0.0);
  return c;
}

/// A unit square of particles held on the left, and pulled and sheared on the right.
inline options::SceneOptions pulled_particles(Index per_side, const Vector<2>& traction)
{
  options::SceneOptions options = held_particles(per_side);
  options.conditions.resize(1); // left
  options.conditions.push_back(pull("right", traction));
  return options;
}

/// |a - b| / |b|; a is a - b after that. Collective.
inline double difference(Vec a, Vec b, NormType norm)
{
  double size = 0.0, gap = 0.0;
  PDX_CALL(VecNorm(b, norm, &size));
  PDX_CALL(VecAXPY(a, -1.0, b));
  PDX_CALL(VecNorm(a, norm, &gap));
  return gap / size;
}
} // namespace pdx::test
