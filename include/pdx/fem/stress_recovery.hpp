#pragma once
#include "pdx/fem/assembly.hpp"
#include "pdx/field/free_strain.hpp"

namespace pdx::fem {
/// Stress in the four corners of a cell [Pa], one column (xx, yy, xy) each: Cauchy stress of the 2 x 2 Gauss points,
/// continued bilinearly to the corners.
/// @param free strain, with small strain only; null: none
Eigen::Matrix<double, 3, 4> corner_stress(const Corners& corners, const ElementVector& displacement,
                                          const law::Elastic& law, Kinematics kinematics,
                                          const field::FreeStrain* free = nullptr);

/// Nodal Cauchy stress (xx, yy, xy) [Pa] at the owned vertices: mean over all their cells, plain and covered, of the
/// stress at their corner. Cells that a crack cuts are left out, as their strain is not that of their nodes; a node
/// with no other cells has 0.
/// @param displacement 2 per local vertex [m]   @return 3 per owned vertex
std::vector<double> nodal_stress(const ElasticBody& body, std::span<const double> displacement,
                                 const field::FreeStrain* free = nullptr);
} // namespace pdx::fem
