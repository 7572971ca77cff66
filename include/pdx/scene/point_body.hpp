#pragma once
#include "pdx/mpm/point_term.hpp"
#include "pdx/scene/model.hpp"
#include "pdx/scene/point_output.hpp"
#include "pdx/scene/point_plan.hpp"

namespace pdx::scene {
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

/// What the bodies of a plan share with those that a checkpoint is of.
template <int Dim> std::string described(const PointPlan<Dim>& plan);

/// Adds how many points of a plan each owned cell of the mesh holds.
template <int Dim>
void add_point_shares(const PointPlan<Dim>& plan, const mesh::Mesh& mesh, std::vector<double>& cells);

/// Bodies of material points, in the plane or in space.
template <int Dim> struct PointBody : Part {
  PointBody(const PointPlan<Dim>& filled, const mesh::Mesh& background, Model& of)
      : plan(filled), mesh(background), model(of), grid(filled, background), description(scene::described<Dim>(filled))
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

/// Rows, Terms and conditions of bodies, ready to be stepped; the one part is a PointBody. Collective. Throws UserError
/// for conditions that are nowhere.
/// @param plan, mesh outlive the result
template <int Dim>
std::unique_ptr<Model> discretise(const options::SceneOptions& options, const PointPlan<Dim>& plan,
                                  const mesh::Mesh& mesh);

/// Turns the boundary conditions into prescribed components and loads of `body.model`; they act on nodes of the grids
/// that lie on a side or in a box, which reaches through space, and loads on the points there or all. Collective.
/// Throws UserError for a place that selects nothing, and for a side that lies within cells.
template <int Dim> void apply_conditions(const options::SceneOptions& options, PointBody<Dim>& body);
} // namespace pdx::scene
