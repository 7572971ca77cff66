#pragma once
#include "pdx/field/output_field.hpp"
#include "pdx/scene/cloud_body.hpp"
#include "pdx/scene/discretisation.hpp"
#include "pdx/scene/solid.hpp"

namespace pdx::record {
/// The mesh with displacement, stress, cell use and rank; and, where there are patches, the particles with
/// displacement, strain-energy density, kind (0 inner, 1 with bonds to elements or missing ones, 2 held), rank, patch.
/// Collective. @param relative_percent Eq. 28 per owned vertex, empty without reference
std::vector<field::OutputBlock> output_blocks(const mesh::Mesh& mesh, const options::SceneOptions& options,
                                              const scene::Discretisation& d, Vec u,
                                              const std::vector<double>& relative_percent);
/// Adds the velocity of particles to their block. @param velocity of owned components [m/s]
void add_velocity(const scene::Discretisation& d, std::span<const double> velocity,
                  std::vector<field::OutputBlock>& blocks);

/// The particles of a solid, with the same fields. Collective.
std::vector<field::OutputBlock> solid_blocks(const options::SceneOptions& options, const scene::Solid& solid, Vec u);

/// The particles of a cloud with displacement, velocity, damage, volume, set and rank. Collective.
/// @param velocity of owned components [m/s]
std::vector<field::OutputBlock> cloud_blocks(const options::SceneOptions& options, const scene::CloudModel& cloud,
                                             Vec u, std::span<const double> velocity);
} // namespace pdx::record
