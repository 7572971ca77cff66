#pragma once
#include "pdx/couple/contact_touch.hpp"

#include <Eigen/Core>

namespace pdx::couple {
/// Of a point and the corners of a facet, in this order, Dim components each.
template <int Dim>
using ContactMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, Dim*(Dim + 1), Dim*(Dim + 1)>;

/// Second derivative of k (d0 - d)^2 / 2 by the places of a point and of a facet that it touches, the place that is
/// touched going along [N/m].
/// @param corners where the facet's points are now [m]   @param stiffness k [N/m]
template <int Dim>
ContactMatrix<Dim> contact_tangent(const Touch<Dim>& touch, std::span<const Vector<Dim>> corners, double stiffness);
} // namespace pdx::couple
