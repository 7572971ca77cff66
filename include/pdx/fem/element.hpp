#pragma once
#include "pdx/base/tensor.hpp"

namespace pdx::fem {
/// small: linear strain of the reference shape. finite: Green-Lagrange strain with the same stiffness, i.e. a
/// St Venant-Kirchhoff solid, which does not feel finite rotations.
enum class Kinematics { small, finite };

/// Displacements [m] or forces [N] of the corners: x and y of corner 1, then of corner 2, ...
using ElementVector = Eigen::Matrix<double, 8, 1>;
/// Tangent [N/m] in the same order.
using ElementMatrix = Eigen::Matrix<double, 8, 8, Eigen::RowMajor>;
} // namespace pdx::fem
