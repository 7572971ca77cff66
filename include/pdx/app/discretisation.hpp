#pragma once
#include "pdx/app/patches.hpp"
#include "pdx/couple/fracture.hpp"
#include "pdx/couple/node_field.hpp"
#include "pdx/couple/step_breaker.hpp"
#include "pdx/fem/elastic_term.hpp"
#include "pdx/field/system.hpp"
#include "pdx/pd/bond_term.hpp"
#include "pdx/xfem/enriched_term.hpp"

namespace pdx::app {
/// Components a boundary condition holds, for its reaction force.
struct HeldPart {
  std::string name;
  std::vector<Index> components; ///< owned, local
};

/// Rows, Terms and loads of a scene on a mesh, ready for a solver. Builds only what the scene declares.
struct Discretisation {
  std::vector<PetscInt> node_rows;     ///< global row of each local vertex, -1 under a patch
  std::vector<Index> nodes;            ///< owned vertices with a row, in order of rows
  std::vector<pd::Particle> particles; ///< owned, in order of rows
  crack::CrackSet cracks;
  geom::Box<2> body;                        ///< that the cracks are in [m]
  std::unique_ptr<xfem::EnrichedSets> sets; ///< null without cracks
  std::vector<couple::Surroundings> around; ///< one per patch
  std::unique_ptr<couple::NodeField> node_field;
  field::System system;
  fem::ElasticTerm* elements = nullptr;       ///< borrowed from system.terms; null without elements
  xfem::EnrichedTerm* cut_elements = nullptr; ///< null without cut elements
  pd::BondTerm<2>* bonds = nullptr;           ///< null without patches
  couple::CarriedBonds<2>* carried = nullptr; ///< null without an interface
  couple::Fracture* fracture = nullptr;       ///< borrowed from system.after; null in time or if nothing can break
  couple::StepBreaker* breaker = nullptr;     ///< borrowed from system.after_step; null in statics or likewise
  std::vector<double> critical_stretch;       ///< per patch [-]; empty if nothing can break
  std::int64_t bonds_at_start = 0;            ///< of all ranks, after the cracks that were given
  std::vector<HeldPart> held_parts;
  Index ghosts = 0; ///< on all ranks [-]
  /// Strain energy density per owned row, bonds that leave their patch included; 0 where no particle is [J/m^3].
  std::vector<double> energy_density(std::span<const double> local) const;
  /// Displacement of every local vertex, 2 each [m]. Collective.
  std::vector<double> vertex_displacement(Vec u) const;
};

/// Collective. The mesh, its covers included, must outlive the result; its cells are cut by the scene's cracks.
std::unique_ptr<Discretisation> discretise(mesh::Mesh& mesh, const SceneOptions& options, const PatchPlan& plan,
                                           std::vector<pd::Particle> particles, bool assembled);
} // namespace pdx::app
