#pragma once
#include "pdx/fem/loads.hpp"
#include "pdx/xfem/enriched_sets.hpp"

namespace pdx::xfem {
/// Adds a constant traction [Pa] on edges of cut cells, to nodes and enriched sets: each half of an edge is loaded with
/// the corner values of its side, so that the work of the load on a jump is exact. Edges of all other cells are
/// fem::add_traction's. Every rank fills its own rows; `sets` must be numbered.
void add_traction(const mesh::Mesh& mesh, const EnrichedSets& sets, std::span<const mesh::BoundaryEdge> edges,
                  const Vector<2>& traction, const fem::Thickness& thickness, const fem::NodalForces& target);

/// Adds the consistent forces of a body force over the cut cells, side by side, with the quadrature they were cut with.
/// All other cells are fem::add_body_force's.
void add_body_force(const mesh::Mesh& mesh, const EnrichedSets& sets, const fem::BodyForce& body_force,
                    const fem::Thickness& thickness, const fem::NodalForces& target);
} // namespace pdx::xfem
