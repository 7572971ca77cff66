#pragma once
#include "pdx/adapt/scene_view.hpp"
#include "pdx/couple/fracture.hpp"
#include "pdx/couple/loose_parts.hpp"
#include "pdx/couple/node_field.hpp"
#include "pdx/fem/elastic_term.hpp"
#include "pdx/pd/bond_term.hpp"
#include "pdx/scene/kept.hpp"
#include "pdx/scene/model.hpp"
#include "pdx/scene/patches.hpp"
#include "pdx/scene/point_output.hpp"
#include "pdx/xfem/enriched_term.hpp"

namespace pdx::scene {
/// Rows, Terms and loads of a scene on a mesh, ready for a solver. Builds only what the scene declares.
struct Discretisation final : Model {
  std::vector<PetscInt> node_rows;          ///< global row of each local vertex, -1 under a patch
  std::vector<Index> nodes;                 ///< owned vertices with a row, in order of rows
  std::unique_ptr<xfem::EnrichedSets> sets; ///< null without cracks
  crack::CrackSet seams;                    ///< where the mesh is parted under and beside patches
  std::vector<couple::Surroundings> around; ///< one per patch
  std::unique_ptr<couple::NodeField> node_field;
  fem::ElasticTerm* elements = nullptr;            ///< borrowed from system.terms; null without elements
  xfem::EnrichedTerm* cut_elements = nullptr;      ///< null without cut elements
  pd::BondTerm<2>* bonds = nullptr;                ///< null without patches
  couple::CarriedBonds<2>* carried = nullptr;      ///< null without an interface
  std::unique_ptr<couple::LooseParts> loose_parts; ///< null in time, where nothing must be held
  const PatchPlan* patch_plan = nullptr;           ///< outlives this
  std::int64_t bonds_at_start = 0;                 ///< of all ranks, after the cracks that were given

  /// Of bodies of material points; null or empty where there are none.
  ///@{
  const PointPlan<2>* point_plan = nullptr; ///< outlives this
  mpm::PointTerm<2>* points = nullptr;      ///< null too where patches cover them all
  std::vector<CellOfBody<2>> point_cells;   ///< those of `points`
  std::vector<std::uint8_t> stays;          ///< per local cell: particles cannot take it
  BodyRows body_rows;
  ///@}
  std::vector<std::uint8_t> side_held; ///< per owned component of nodes: held, and particles there would not be as well
  adapt::SceneView view(const mesh::Mesh& mesh) const; ///< there are patches
  /// Displacement of every local vertex, 2 each [m]. Collective.
  std::vector<double> vertex_displacement(Vec u) const;
};

/// Collective. The mesh, its covers included, must outlive the result; its cells are cut by the scene's cracks.
/// @param points of a mixed scene, whose cells have been dealt (`deal_cells`); null without bodies of points
/// @param areas of the mesh, where another scene on it may follow; must outlive the result
/// @param kept of the scene before on the same mesh, which this one goes on with; null: all is made
std::unique_ptr<Discretisation> discretise(mesh::Mesh& mesh, const options::SceneOptions& options,
                                           const PatchPlan& plan, std::vector<pd::Particle> particles, bool assembled,
                                           const PointPlan<2>* points = nullptr,
                                           const fem::CornerAreas* areas = nullptr, Kept* kept = nullptr);
} // namespace pdx::scene
