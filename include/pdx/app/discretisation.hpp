#pragma once
#include "pdx/app/patches.hpp"
#include "pdx/fem/elastic_term.hpp"
#include "pdx/pd/bond_term.hpp"

namespace pdx::app {
/// Components a boundary condition holds, for its reaction force.
struct HeldPart {
  std::string name;
  std::vector<Index> components; ///< owned, local
};

/// Rows, Terms and loads of a scene on a mesh, ready for a solver. Builds only what the scene declares.
struct Discretisation {
  std::vector<PetscInt> node_rows;          ///< global row of each local vertex, -1 under a patch
  std::vector<Index> nodes;                 ///< owned vertices with a row, in order of rows
  std::vector<pd::Particle> particles;      ///< owned, in order of rows
  std::vector<couple::Surroundings> around; ///< one per patch
  std::unique_ptr<couple::NodeField> node_field;
  field::System system;
  fem::ElasticTerm* elements = nullptr;       ///< borrowed from system.terms; null without plain cells
  pd::BondTerm<2>* bonds = nullptr;           ///< null without patches
  couple::CarriedBonds<2>* carried = nullptr; ///< null without an interface
  std::vector<HeldPart> held_parts;
  Index ghosts = 0; ///< on all ranks [-]
  /// Displacement of every local vertex, 2 each [m]. Collective.
  std::vector<double> vertex_displacement(Vec u) const;
};

/// Collective. The mesh, its covers included, must outlive the result.
std::unique_ptr<Discretisation> discretise(const mesh::Mesh& mesh, const SceneOptions& options, const PatchPlan& plan,
                                           std::vector<pd::Particle> particles, bool assembled);
} // namespace pdx::app
