#pragma once
#include "pdx/field/system.hpp"
#include "pdx/scene/point_plan.hpp"

namespace pdx::scene {
/// What bodies of points begin with: each moves and turns as a rigid one. Rows of other bodies are left as they are.
/// @param body per owned row, a number of the plan's bodies or above them
template <int Dim>
void throw_bodies(const options::PointOptions& options, const PointPlan<Dim>& plan, std::span<const Index> body,
                  field::System& system);
} // namespace pdx::scene
