#pragma once
#include "pdx/scene/cloud_body.hpp"
#include "pdx/scene/patches.hpp"

namespace pdx::scene {
/// What is odd but allowed about a cloud, a line each: particles without a bond, particles so near to each other that
/// they rule the step, bonds across gaps. The same on every rank. Collective.
template <int Dim>
std::vector<std::string> cloud_warnings(const options::SceneOptions& options, const CloudPart<Dim>& body);

/// Throws UserError for a body of one row of particles. @param count particles along each axis, layers included
template <std::size_t Dim> void require_rows(const options::SceneOptions& options, const std::array<Index, Dim>& count);

/// Says how far a body of few rows is from one that is as stiff as its material; empty for a thick one.
std::string thin_warning(const options::SceneOptions& options, const PatchPlan& plan);
std::string thin_warning(const options::SceneOptions& options, const std::array<Index, 3>& count,
                         const pd::Stencil<3>& stencil, const std::optional<pd::SolidSides>& sides);

/// Says which region has no element and no particle, so that it changes nothing; empty if each has one. Collective.
std::string region_warning(const options::SceneOptions& options, const mesh::Mesh& mesh,
                           std::span<const pd::Particle> particles);

/// Says that the default correction of free sides had to give way to `volume`; empty where it had not.
std::string correction_warning(const options::SceneOptions& options, const PatchPlan& plan);
std::string correction_warning(const options::SceneOptions& options, const std::optional<pd::SolidSides>& sides);

/// Says which patch has an inner corner so near to a side of the body that the correction of the side is not exact
/// there; empty if none has. @param body  the box around the mesh [m]
std::string corner_warning(const PatchPlan& plan, const geom::Box<2>& body, const geom::Frame& frame);
} // namespace pdx::scene
