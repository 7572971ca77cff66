#pragma once
#include "pdx/base/petsc.hpp"
#include "pdx/geom/box.hpp"
#include "pdx/mpm/grid_kernel.hpp"
#include "pdx/mpm/grid_nodes.hpp"

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pdx::mpm {
/// Nodes that are held along an axis, or along any direction: those in a box of space, whatever points come by.
template <int Dim> struct GridHold {
  geom::Box<Dim> box; ///< [m]
  int axis = 0;
  std::function<double(double time)> velocity; ///< [m/s]
  std::optional<Vector<Dim>> along{};          ///< unit vector, instead of the axis
  std::function<double(double time)> spin{};   ///< of what turns in the plane; none: nothing turns [1/s]
  Vector<2> centre = Vector<2>::Zero();        ///< about that [m]

  /// The velocity that a node is held at, when that of others is `shift` and what turns does so at `turn`.
  double at(const Vector<Dim>& node, double shift, double turn) const
  {
    if (turn == 0.0 || axis > 1) return shift;
    return shift + (axis == 0 ? -turn * (node[1] - centre[1]) : turn * (node[0] - centre[0]));
  }
};

/// Bodies of material points on a grid that is fixed in space and made anew each step [PDMPM section 2]. Each rank
/// moves the points it was given, wherever they go; nodes that several ranks see are added up between them. Bodies
/// share the grid, and so do not pass through each other. The grid has no ends.
template <int Dim> class GridMotion {
public:
  /// @param origin a node of the grid [m]   @param points of each body, on this rank, numbered from 0   Collective.
  GridMotion(MPI_Comm comm, const GridRule& rule, const Vector<Dim>& origin, std::vector<BodyMaterial> bodies,
             std::vector<std::vector<GridPoint<Dim>>> points);

  void hold(GridHold<Dim> hold) { holds_.push_back(std::move(hold)); }
  /// Force on each point of a body [N].
  void set_push(std::size_t body, const Vector<Dim>& push) { push_[body] = push; }

  /// The length of a step is `length`; the velocity is changed over `kick`: half a step where it begins at rest in
  /// time. Throws SolverFailure for points that are nowhere. Collective.
  void step(double time, double length, double kick);

  /// All of this rank.
  ///@{
  PointEnergies energies() const;                             ///< [J]
  std::vector<GridPoint<Dim>> points(std::size_t body) const; ///< in order of numbers
  const PointLanes<Dim>& lanes(std::size_t body) const { return points_[body]; }
  double work() const { return work_; } ///< of what holds and pushes, since the start [J]
  ///@}
  /// The points of each body at the end of the last step: their velocities are half a step behind. Collective.
  /// @param half of that step [s]
  const std::vector<PointLanes<Dim>>& ended(double half);
  void resume(std::vector<std::vector<GridPoint<Dim>>> points, double work, double time = 0.0);
  const GridRule& rule() const { return rule_; }
  Vector<Dim> place(const GridPoint<Dim>& point) const { return origin_ + rule_.side * point.at; } ///< [m]
  std::span<const double> hold_force() const
  {
    return hold_force_;
  } ///< on each hold's nodes in the last step, this rank's part [N]

private:
  /// Layers of nodes across the last axis, both within.
  struct Layers {
    Index from = std::numeric_limits<Index>::min(), to = std::numeric_limits<Index>::max();
  };
  void lay_grid();
  bool find_seen();
  void share_nodes();
  void find_borders();
  bool too_wide(const Site<Dim>& lower, const Site<Dim>& upper, bool any) const;
  void regroup();
  std::string failure(const std::string& why, double speed) const;
  void give_all(const Giving& what);
  void take_all(const Taking& what);
  void settle_velocity(bool momentum, bool force, double kick);
  void hold_nodes(double time, double kick, bool force, bool brought, const Layers& layers = {});
  void roll_node(std::size_t hold, std::size_t at, double kick, bool force, bool brought);
  void musl_step(double end, double length, double kick);
  std::pair<std::size_t, std::size_t> nodes_of(const Layers& layers) const;
  SomeBlocks layer_of(std::size_t body, Index layer) const;
  template <class Visit> void for_each_inner(Index layer, Visit&& visit) const;
  void take_from(std::size_t body, Taking what, const SomeBlocks& blocks);

  MPI_Comm comm_;
  GridRule rule_;
  Vector<Dim> origin_;
  std::vector<BodyMaterial> bodies_;
  std::vector<PointLanes<Dim>> points_, ended_; // memory of the latter is kept
  std::vector<Vector<Dim>> push_;
  std::vector<GridHold<Dim>> holds_;
  GridNodes<Dim> nodes_;
  /// On several ranks, so that the order of sums depends on where points are and not on where they were: blocks with
  /// points, by body, and the box of the nodes that those see.
  ///@{
  std::vector<std::vector<std::uint8_t>> filled_;
  Site<Dim> first_seen_{}, last_seen_{};
  ///@}
  std::vector<std::vector<std::vector<SomeBlocks>>> inner_; ///< by body and layer: whose nodes no other rank has
  std::vector<std::vector<SomeBlocks>> border_;             ///< by body: the others
  double work_ = 0.0, time_ = 0.0;                          ///< [J]; at the end of the last step [s]
  std::vector<double> hold_force_;
  double point_mass_ = 0.0; ///< least of all [kg]
  Processor processor_ = chosen_processor();
};
} // namespace pdx::mpm
