#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/law/kinematics.hpp"

namespace pdx::fem {
using law::Kinematics;

/// Displacements [m] or forces [N] of the corners: x and y of corner 1, then of corner 2, ...
using ElementVector = Eigen::Matrix<double, 8, 1>;
/// Tangent [N/m] in the same order.
using ElementMatrix = Eigen::Matrix<double, 8, 8, Eigen::RowMajor>;
} // namespace pdx::fem
