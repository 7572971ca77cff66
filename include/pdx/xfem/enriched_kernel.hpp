#pragma once
#include "pdx/fem/element.hpp"
#include "pdx/law/elastic.hpp"
#include "pdx/xfem/enriched_element.hpp"

namespace pdx::xfem {
/// What corner values of the field on one side an element's unknowns give.
using SideMap = Eigen::Matrix<double, 8, Eigen::Dynamic, Eigen::RowMajor, 8, 16>;

/// On one side of the crack Eq. 12 is a plain bilinear field with the corner values u_i + (H - H_i) a_i: the map from
/// (u, a) to these values. The kernels below sum plain elements over both sides through it [XPD1 Eqs. 12, 13].
SideMap side_map(const EnrichedElement& element, Side side);

/// Internal force [N] of all unknowns, the gradient of `enriched_energy`. The crack faces carry nothing.
EnrichedVector enriched_force(const EnrichedElement& element, const EnrichedVector& displacement,
                              const law::Elastic& law, law::Kinematics kinematics);

/// Tangent [N/m], the derivative of `enriched_force`; symmetric [XPD1 Eq. 13].
EnrichedMatrix enriched_tangent(const EnrichedElement& element, const EnrichedVector& displacement,
                                const law::Elastic& law, law::Kinematics kinematics);

/// Strain energy [J].
double enriched_energy(const EnrichedElement& element, const EnrichedVector& displacement, const law::Elastic& law,
                       law::Kinematics kinematics);
} // namespace pdx::xfem
