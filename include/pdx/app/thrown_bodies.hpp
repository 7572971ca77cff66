#pragma once
#include "pdx/app/point_plan.hpp"
#include "pdx/field/system.hpp"

namespace pdx::app {
/// What bodies of points begin with: each moves and turns as a rigid one. Rows of other bodies are left as they are.
/// @param body per owned row, a number of the plan's bodies or above them
template <int Dim>
void throw_bodies(const PointOptions& options, const PointPlan<Dim>& plan, std::span<const Index> body,
                  field::System& system);
} // namespace pdx::app
