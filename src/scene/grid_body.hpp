#pragma once
#include "pdx/mpm/grid_motion.hpp"
#include "pdx/scene/grid_body.hpp"

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
  GridBody(const options::SceneOptions& options, const PointPlan<Dim>& plan, const mesh::Mesh& mesh);

  post::Energies energies(std::span<const double> local) const override;
  Model::Tiles cells_of_points() const override { return {}; } ///< its cells keep no points
  field::OutputBlock block(std::span<const double> local, std::span<const double> velocity) const override;
  std::vector<io::Column> more_columns() const override;
  void add_more(std::span<const double> local, std::span<const double> velocity,
                std::vector<double>& row) const override;

  double limit() const { return limit_; } ///< of a step [s]

  std::unique_ptr<mpm::GridMotion<Dim>> motion;
  std::vector<Index> first;       ///< owned row of the first point of each body
  std::vector<std::string> holds; ///< names of what is held, one for each hold of the motion
  std::vector<GridPush> pushes;
  std::vector<mpm::BodyMaterial> materials;
  Vector<Dim> origin = Vector<Dim>::Zero(); ///< a node of the grid [m]

private:
  std::vector<std::vector<mpm::GridPoint<Dim>>> lay_points(const mesh::Mesh& mesh, double side);
  std::vector<int> natural_; // numbers of the owned points on all ranks
  double limit_ = 0.0;
};

/// Turns boundary conditions into holds of nodes and pushes; and into velocities of points at the start. Throw
/// UserError. Collective.
///@{
template <int Dim> void apply_conditions(const options::SceneOptions& options, GridBody<Dim>& body);
template <int Dim> void throw_points(const options::SceneOptions& options, GridBody<Dim>& body);
///@}
} // namespace pdx::scene
