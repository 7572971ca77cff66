#pragma once
#include "pdx/scene/discretisation.hpp"

namespace pdx::scene {
/// Fills the bodies of points, reads the mesh of elements if there is one, and moves the options into the frame of all:
/// `options.mesh` has all cells then. Collective. Throws UserError, alike on every rank.
std::shared_ptr<const PointPlan<2>> settle_mixed(MPI_Comm comm, options::SceneOptions& options);

/// Tells the cells of a mesh which body they are of, and which have material points in them. Patches that a rank's
/// options describe are covered afterwards.
void deal_cells(const PointPlan<2>& plan, mesh::Mesh& mesh);

/// What cracks that are given disconnect is particles from the start [APDMPM Eq. 26]: cells of bodies of points as near
/// to one as the margin of triggers says become boxes of `-pd_patches`, where none covers them.
void convert_along_cracks(const PointPlan<2>& plan, options::SceneOptions& options);

/// Adds the Term of the material points that no patch covers. Collective. Throws UserError for a patch that takes part
/// of a cell's points, or points of another material.
void add_points(const mesh::Mesh& mesh, const options::SceneOptions& options, const PointPlan<2>& plan,
                Discretisation& d);

/// Adds contact between bodies, of points, particles and elements, if they may touch, and the velocities that bodies
/// begin with. Collective.
void add_bodies(const mesh::Mesh& mesh, const options::SceneOptions& options, Discretisation& d);

/// Begins the books of the bodies. Collective, once the system is bound.
void keep_books(Discretisation& d);

/// The bodies of points of such a scene, which outlives it, whether patches cover all of them or not.
std::unique_ptr<Part> mixed_part(const mesh::Mesh& mesh, const Discretisation& d);
} // namespace pdx::scene
