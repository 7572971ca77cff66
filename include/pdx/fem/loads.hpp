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

/// Of a plate, alike everywhere or cell by cell [m].
class Thickness {
public:
  Thickness(double everywhere) : everywhere_(everywhere) {} // NOLINT(google-explicit-constructor): most plates are even
  explicit Thickness(std::function<double(Index cell)> of_cell) : of_cell_(std::move(of_cell)) {}
  double operator()(Index cell) const { return of_cell_ ? of_cell_(cell) : everywhere_; }

private:
  double everywhere_ = 0.0;
  std::function<double(Index)> of_cell_;
};

/// Adds a constant traction [Pa] on edges of plain cells, half of each edge's force to either end; edges of covered
/// cells carry nothing.
void add_traction(const mesh::Mesh& mesh, std::span<const mesh::BoundaryEdge> edges, const Vector<2>& traction,
                  const Thickness& thickness, const NodalForces& target);

/// Force per volume [N/m^3] at a point [m].
using BodyForce = std::function<Vector<2>(const Vector<2>& x)>;

/// Adds the consistent nodal forces of a body force over the plain cells, by 2 x 2 Gauss points.
void add_body_force(const mesh::Mesh& mesh, const BodyForce& body_force, const Thickness& thickness,
                    const NodalForces& target);
} // namespace pdx::fem
