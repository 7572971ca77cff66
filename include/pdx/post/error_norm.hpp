#pragma once
#include "pdx/mesh/mesh.hpp"

namespace pdx::post {
/// How far a displacement is from a reference, over all mesh vertices.
struct DisplacementError {
  double max_relative_percent = 0.0;    ///< largest | |u_ref| - |u| | / |u_ref|  [XPD1 Eq. 28], where u_ref is not 0
  double mean_relative_percent = 0.0;   ///< its mean over the same vertices
  double vector_l2_percent = 0.0;       ///< |u - u_ref|_2 / |u_ref|_2
  double vector_max_percent = 0.0;      ///< max |u - u_ref| / max |u_ref|
  std::vector<double> relative_percent; ///< Eq. 28 per owned vertex, 0 where u_ref is 0
};

/// Collective. @param u, reference displacement per local vertex, 2 each [m]
DisplacementError compare_displacement(const mesh::Mesh& mesh, std::span<const double> u,
                                       std::span<const double> reference);
} // namespace pdx::post
