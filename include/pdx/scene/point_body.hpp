#pragma once
#include "pdx/field/output_field.hpp"
#include "pdx/field/row_name.hpp"
#include "pdx/mpm/point_term.hpp"
#include "pdx/scene/model.hpp"
#include "pdx/scene/point_output.hpp"
#include "pdx/scene/point_plan.hpp"

namespace pdx::scene {
/// Bodies of material points, in the plane or in space: rows, Terms and conditions, ready to be stepped.
struct PointModel : Model {
  std::string description;                ///< that a checkpoint of the same bodies shares
  std::vector<field::RowName> node_names; ///< of the owned rows

  /// Fields of the owned points. @param local displacement [owned | halo] [m]   @param velocity likewise [m/s]
  virtual field::OutputBlock block(std::span<const double> local, std::span<const double> velocity) const = 0;
  /// The same at a vector of displacements. Collective. @param velocity of owned components [m/s]
  std::vector<field::OutputBlock> blocks(Vec u, std::span<const double> velocity) const;
  Tiles tiles() const override { return {}; }
};

/// How the bodies of a plan stand in the rows of a mesh, as one rank sees it.
template <int Dim> struct PointRows {
  /// A cell of a body's grid with points in it, and the global rows of its corners, x fastest.
  struct Cell {
    Index body = 0;
    Site<Dim> at{};
    std::array<PetscInt, (1U << Dim)> rows{};
  };
  std::vector<Cell> cells; ///< over local cells of the mesh, those of owned ones first
  std::size_t owned = 0;   ///< how many these are
  /// Of the owned rows.
  ///@{
  std::vector<Index> body;
  std::vector<Vector<Dim>> place; ///< in the reference state [m]
  std::vector<field::RowName> names;
  ///@}
  field::Rows rows;

  /// Collective.
  PointRows(const PointPlan<Dim>& plan, const mesh::Mesh& mesh);
};

template <int Dim> struct PointBody : PointModel {
  PointBody(const PointPlan<Dim>& filled, const mesh::Mesh& mesh) : plan(filled), grid(filled, mesh) {}

  const PointPlan<Dim>& plan; ///< outlives this
  PointRows<Dim> grid;
  mpm::PointTerm<Dim>* term = nullptr; ///< borrowed from system.terms

  std::vector<CellOfBody<Dim>> owned_cells() const; ///< with points, in order of the mesh
  Tiles cells_of_points() const override { return {term->cells_computed(), term->cells_skipped()}; }
  BodyRows rows_of_bodies() const;

  post::Energies energies(std::span<const double> local) const override;
  field::OutputBlock block(std::span<const double> local, std::span<const double> velocity) const override;
};

/// Collective. Throws UserError for conditions that are nowhere.
/// @param plan outlives the body
template <int Dim>
std::unique_ptr<PointBody<Dim>> discretise(const options::SceneOptions& options, const PointPlan<Dim>& plan,
                                           const mesh::Mesh& mesh);

/// What the bodies of a plan share with those that a checkpoint is of.
template <int Dim> std::string described(const PointPlan<Dim>& plan);

/// Turns the boundary conditions into prescribed components and loads of `body.system`; they act on nodes of the grids
/// that lie on a side or in a box, which reaches through space, and loads on the points there or all. Collective.
/// Throws UserError for a place that selects nothing, and for a side that lies within cells.
template <int Dim> void apply_conditions(const options::SceneOptions& options, PointBody<Dim>& body);
} // namespace pdx::scene
