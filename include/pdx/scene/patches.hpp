#pragma once
#include "pdx/couple/surroundings.hpp"
#include "pdx/field/row_name.hpp"
#include "pdx/options/scene_options.hpp"
#include "pdx/pd/particles.hpp"
#include "pdx/pd/side_weights.hpp"

namespace pdx::scene {
class Kept;

/// Where the patches lie and of what they are made. For `-pd_patches all` the one patch is the body and its layers.
struct PatchPlan {
  std::vector<couple::PatchShape> shapes;
  std::vector<std::vector<std::size_t>> entries; ///< per patch: which of -pd_patches it is made of, ascending
  std::vector<pd::Stencil<2>> stencils;
  geom::Box<2> body;                                 ///< without layers [m]; of box meshes only
  std::vector<std::optional<pd::SideWeights>> sides; ///< per patch: of the exact surface correction, where it is used
};

/// Of the exact surface correction in space, where it is wanted and can be had. Throws UserError where it is demanded
/// and cannot. @param alone  without points around
std::optional<pd::SolidSides> solid_sides(const options::PdOptions& pd, const pd::Stencil<3>& stencil, bool alone);

/// The lattice of particles in a box. Throws UserError for a spacing that does not fit, naming one that does.
template <int Dim> geom::Lattice<Dim> lattice_in(const geom::Box<Dim>& box, double dx);

/// Background cells of particles-only scenes, about 4 dx wide.
std::array<Index, 2> background_cells(const geom::Lattice<2>& lattice);

/// Where patches lie, their sites named. Throws UserError for a spacing that does not fit.
std::vector<couple::PatchShape> patch_shapes(const options::SceneOptions& options);

/// Adds the names of some sites of a patch. @param sites their places in it, ascending
void add_names(const couple::PatchShape& shape, std::span<const Index> sites, std::vector<field::RowName>& names);

/// Lays out the patches before the mesh is built; completes the mesh options of peridynamics-only scenes (background
/// cells of about 4 dx around body and layers). Throws UserError for a spacing that does not fit, naming one that does.
/// @param known of another layout of the same scene, whose stencils are taken where spacings are the same; or null
PatchPlan plan_patches(const options::SceneOptions& options, mesh::MeshOptions& mesh, const PatchPlan* known = nullptr);

/// Cost of a cell in the static solver: every cell carries the coarse level, plain ones elements, covered ones their
/// particles.
mesh::CellCost cell_cost(const PatchPlan& plan);

/// Local cells whose middle a patch holds, ascending.
std::vector<Index> cells_under(const mesh::Mesh& mesh, const couple::PatchShape& shape);

/// The spacing nearest to dx that divides all sides, 0 if there is none within a factor of two [m].
double nearest_fit(std::span<const double> sides, double dx);

/// Switches off the cells under the patches. Throws UserError if a patch leaves the mesh or cuts elements. Collective.
/// @param frame of coordinates in messages   @param kept has covered patches that stay, and is told what others cover
void cover_cells(mesh::Mesh& mesh, const PatchPlan& plan, const mesh::MeshOptions& options,
                 const geom::Frame& frame = {}, Kept* kept = nullptr);

/// The particles in the covered cells this rank owns, by patch and site. Collective.
/// @param kept knows those of patches that stay; null: all are looked for
std::vector<pd::Particle> make_particles(const mesh::Mesh& mesh, const PatchPlan& plan, Kept* kept = nullptr);
} // namespace pdx::scene
