#pragma once
#include "pdx/mesh/mesh.hpp"
#include "pdx/options/scene_options.hpp"

namespace pdx::record {
/// Solved before the scene itself, where asked for.
struct Prior {
  std::vector<double> reference;      ///< elements-only displacement per local vertex [m]
  std::vector<double> energy_release; ///< -dPi/da of each tip [J/m^2]
};

/// The elements-only solution of the same scene at every local vertex, for [XPD1 Eq. 28] [m]. Collective. Throws
/// SolverFailure. @param mesh without covers, before and after
std::vector<double> reference_displacement(mesh::Mesh& mesh, const options::SceneOptions& options);
} // namespace pdx::record
