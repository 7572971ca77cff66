#pragma once
#include "pdx/scene/model.hpp"
#include "pdx/scene/patches.hpp"

namespace pdx::scene {
/// A body in space: that of the plane, extruded along z from 0 to the thickness, of particles only. The background mesh
/// stays in the plane; a cell holds whole columns of particles, so that ranks part the body along z.
struct SolidPlan {
  PatchPlan columns; ///< the body in the plane as one patch, without stencil
  geom::Lattice<3> lattice;
  pd::Stencil<3> stencil;
  std::optional<pd::SolidSides> sides; ///< of the exact surface correction, where it is used
};

/// Completes the mesh options by background cells of about 4 dx. Throws UserError for a spacing that does not fit all
/// three sides, naming one that does, and for a horizon that makes no stencil.
SolidPlan plan_solid(const options::SceneOptions& options, mesh::MeshOptions& mesh);

/// Cost of a cell: its particles.
mesh::CellCost cell_cost(const SolidPlan& plan);

/// The particles over the cells this rank owns, by site of the lattice in space; `Particle::x` is in the plane.
/// Collective.
std::vector<pd::Particle> make_particles(const mesh::Mesh& mesh, const SolidPlan& plan, pd::Particles& swarm);

/// Rows, Terms and conditions of a solid, ready to be stepped explicitly. Collective. Throws UserError for conditions
/// and cracks that are nowhere in the body.
std::unique_ptr<Model> discretise(MPI_Comm comm, const options::SceneOptions& options, const SolidPlan& plan,
                                  std::vector<pd::Particle> particles);

/// Turns the boundary conditions into prescribed components and loads of `solid`. On sides left and right (x),
/// bottom and top (y), back and front (z); boxes reach through the thickness. Collective. Throws UserError for an
/// unknown side and a place that selects nothing.
void apply_conditions(const options::SceneOptions& options, const geom::Lattice<3>& lattice, Model& solid);
} // namespace pdx::scene
