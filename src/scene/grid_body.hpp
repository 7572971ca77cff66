#pragma once
#include "pdx/mpm/grid_motion.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/scene.hpp"

#include <nlohmann/json.hpp>

namespace pdx::scene {
/// What a body force does: a force on each point of a body, by a history.
struct GridPush {
  std::size_t body = 0;
  Vector<3> force = Vector<3>::Zero(); ///< on a point [N]
  field::History history;
};

/// Points of a plan on a grid that is made anew each step.
template <int Dim> struct GridBody final : PointBody<Dim> {
  GridBody(const options::SceneOptions& options, const PointPlan<Dim>& plan, const mesh::Mesh& mesh, Model& model);

  void add_energies(std::span<const double> local, post::Energies& mine) const override;
  Tiles cells() const override { return {}; } ///< its cells keep no points
  void add_columns(std::vector<io::Column>& columns) const override;
  void add_row(std::span<const double> local, std::span<const double> velocity,
               std::vector<double>& row) const override;

  double limit() const { return limit_; } ///< of a step [s]

  std::unique_ptr<mpm::GridMotion<Dim>> motion;
  std::vector<Index> first; ///< owned row of the first point of each body
  /// A column of what is held: a hold of the motion, and what part of its force lies along the column's axis.
  struct HeldColumn {
    std::string name;
    std::size_t hold = 0;
    double part = 1.0;
  };
  std::vector<HeldColumn> holds;
  std::size_t held_places = 0; ///< holds of the motion
  std::vector<GridPush> pushes;
  std::vector<mpm::BodyMaterial> materials;
  Vector<Dim> origin = Vector<Dim>::Zero(); ///< a node of the grid [m]

protected:
  field::OutputBlock block(std::span<const double> local, std::span<const double> velocity) const override;

private:
  std::vector<std::vector<mpm::GridPoint<Dim>>> lay_points(double side);
  std::vector<int> natural_; // numbers of the owned points on all ranks
  double limit_ = 0.0;
};

/// Turns boundary conditions into holds of nodes and pushes; and into velocities of points at the start. Throw
/// UserError. Collective.
///@{
template <int Dim> void apply_conditions(const options::SceneOptions& options, GridBody<Dim>& body);
template <int Dim> void throw_points(const options::SceneOptions& options, GridBody<Dim>& body);
///@}

/// Bodies of material points on a grid that is fixed in space and made anew each step, as a scene in time: its rows are
/// the points themselves, wherever they go on the rank that they were dealt to.
SceneMaker grid_scene(MPI_Comm comm, options::SceneOptions& options);
} // namespace pdx::scene
