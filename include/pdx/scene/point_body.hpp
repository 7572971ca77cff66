#pragma once
#include "pdx/mpm/grid_cell.hpp"
#include "pdx/mpm/point_term.hpp"
#include "pdx/scene/model.hpp"
#include "pdx/scene/point_output.hpp"
#include "pdx/scene/point_plan.hpp"

namespace pdx::scene {
/// Particles that have taken cells of bodies of points whole, as one rank sees it.
template <int Dim> struct TakenCells {
  std::function<bool(const mpm::GridPlace<Dim>& cell)> has; ///< alike on every rank
  /// A particle on a site of a body's lattice.
  struct Particle {
    Index body;
    Site<Dim> site;
  };
  std::vector<Particle> particles; ///< owned, in order of their rows
};

/// How the bodies of a plan stand in the rows of a mesh, as one rank sees it.
template <int Dim> struct PointRows {
  using Cell = mpm::GridCell<Dim>;
  std::vector<Cell> cells; ///< with points in them, over local cells of the mesh, those of owned ones first
  std::size_t owned = 0;   ///< how many these are
  std::vector<mpm::GridPlace<Dim>> nodes; ///< of owned rows, which come first
  /// Of all owned rows: nodes, then particles.
  ///@{
  std::vector<Index> body;
  std::vector<Vector<Dim>> place; ///< in the reference state [m]
  ///@}
  std::vector<field::RowName> names; ///< of nodes
  field::Rows rows;

  /// Collective. @param taken by particles; null: no cell is
  PointRows(const PointPlan<Dim>& plan, const mesh::Mesh& mesh, const TakenCells<Dim>* taken = nullptr);
};

/// What the bodies of a plan share with those that a checkpoint is of.
template <int Dim> std::string described(const PointPlan<Dim>& plan);

/// Adds how many points of a plan each owned cell of the mesh holds.
template <int Dim>
void add_point_shares(const PointPlan<Dim>& plan, const mesh::Mesh& mesh, std::vector<double>& cells);

/// Bodies of material points, in the plane or in space.
template <int Dim> struct PointBody : Part {
  /// @param taken as for PointRows
  PointBody(const PointPlan<Dim>& filled, const mesh::Mesh& background, Model& of,
            const TakenCells<Dim>* taken = nullptr)
      : plan(filled), mesh(background), model(of), grid(filled, background, taken),
        description(scene::described<Dim>(filled))
  {}

  const PointPlan<Dim>& plan; ///< all three outlive this
  const mesh::Mesh& mesh;
  Model& model;
  PointRows<Dim> grid;
  mpm::PointTerm<Dim>* term = nullptr; ///< borrowed from the model
  std::string description;             ///< that a checkpoint of the same bodies shares

  std::vector<CellOfBody<Dim>> owned_cells() const; ///< with points, in order of the mesh
  BodyRows rows_of_bodies() const;

  void add_names(std::vector<field::RowName>& names) const override;
  void add_numbers(std::vector<PetscInt>& first) const override;
  void add_energies(std::span<const double> local, post::Energies& mine) const override;
  bool is_of_points() const override { return true; }
  void add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const override;
  std::string described() const override { return "points = " + description + "\n"; }
  void add_columns(std::vector<io::Column>& columns) const override;
  void add_row(std::span<const double> local, std::span<const double> velocity,
               std::vector<double>& row) const override;
  Tiles cells() const override { return {term->cells_computed(), term->cells_skipped()}; }
  bool works_in(const field::Term&) const override { return true; } ///< contact between bodies, too
  void add_shares(std::vector<double>& cells) const override { add_point_shares(plan, mesh, cells); }

protected:
  /// Fields of the owned points. @param local displacement [owned | halo] [m]   @param velocity likewise [m/s]
  virtual field::OutputBlock block(std::span<const double> local, std::span<const double> velocity) const;
};

/// Adds the Term of the material points of a body's rows to its model. Collective.
template <int Dim>
void add_points(const PointPlan<Dim>& plan, const options::PointOptions& options, PointBody<Dim>& body);

/// Rows, Terms and conditions of bodies, ready to be stepped; the one part is a PointBody. Collective. Throws UserError
/// for conditions that are nowhere.
/// @param plan, mesh outlive the result
template <int Dim>
std::unique_ptr<Model> discretise(const options::SceneOptions& options, const PointPlan<Dim>& plan,
                                  const mesh::Mesh& mesh);

/// Turns the boundary conditions into prescribed components and loads of `body.model`; they act on nodes of the grids
/// that lie on a side or in a box, which reaches through space, and loads on the points there or all; on particles in
/// their place, those beside a side or in a box. Collective.
/// Throws UserError for a place that selects nothing, and for a side that lies within cells.
template <int Dim> void apply_conditions(const options::SceneOptions& options, PointBody<Dim>& body);

/// Of each body, by number of the cell: has it a node that a condition holds where particles in its place would not be
/// held as it is: on a side, or at the border of a box? Alike on every rank.
template <int Dim>
std::vector<std::vector<std::uint8_t>> side_held_cells(const options::SceneOptions& options,
                                                       const PointPlan<Dim>& plan);
} // namespace pdx::scene
