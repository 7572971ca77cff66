#pragma once
#include "pdx/record/tip_j.hpp"

#include <nlohmann/json_fwd.hpp>

namespace pdx::record {
/// Refuses contours that do not fit, lie outside all patches or come within a bond of the tip they are to hold, a ring
/// that is not of elements all around, and a moved tip that would leave its patch: before anything is solved.
/// Collective.
void require_contours(const Solved& solved);

/// -dPi/da of each tip, the crack's end moved forth and back along its direction: in a patch by the lattice's period
/// that way (a spacing along x and y, eight at 30 degrees), in elements by one. Two solves of the whole load path each
/// [J/m^2]. Leaves the mesh plain. Collective.
std::vector<double> energy_release(mesh::Mesh& mesh, const options::SceneOptions& options, const scene::PatchPlan& plan,
                                   std::span<const pd::Particle> particles, bool assembled);

/// Adds J, and modes if asked for, on contours and over elements, the stress intensity and the tips to the results.
/// Collective.
/// @param release of `energy_release`, empty if nobody asked
/// @returns why J is not there for a tip that it was asked for, which has grown; empty if it is
std::string add_crack_results(const Solved& solved, const CrackState& state, std::span<const double> release,
                              nlohmann::json& results);

/// What the log says of tips that J was found at, a line each.
/// @param results  with the `tips` of `add_crack_results`
std::vector<std::string> tip_lines(const nlohmann::json& results);
} // namespace pdx::record
