#pragma once
#include "pdx/field/rows.hpp"
#include "pdx/mesh/mesh.hpp"

#include <functional>

namespace pdx::fem {
/// Where nodal forces go: every rank fills its own rows from its local edges and cells, nothing travels.
struct NodalForces {
  std::span<const PetscInt> node_rows; ///< global row of every local vertex, -1 if inactive
  const field::Rows& rows;
  std::span<double> force; ///< owned rows * 2; loads are added [N]
};

/// Adds a constant traction [Pa] on edges of plain cells, half of each edge's force to either end; edges of covered
/// cells carry nothing. @param thickness [m]
void add_traction(const mesh::Mesh& mesh, std::span<const mesh::BoundaryEdge> edges, const Vector<2>& traction,
                  double thickness, const NodalForces& target);

/// Force per volume [N/m^3] at a point [m].
using BodyForce = std::function<Vector<2>(const Vector<2>& x)>;

/// Adds the consistent nodal forces of a body force over the plain cells, by 2 x 2 Gauss points. @param thickness [m]
void add_body_force(const mesh::Mesh& mesh, const BodyForce& body_force, double thickness, const NodalForces& target);
} // namespace pdx::fem
