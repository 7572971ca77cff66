#pragma once
#include "pdx/field/history.hpp"
#include "pdx/geom/box.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace pdx::options {
/// Springs between a side of the body and the ground.
struct Springs {
  double along = 0.0, across = 0.0;   ///< stiffness along a direction, and across it, by area of the side [N/m^3]
  std::optional<Vector<3>> direction; ///< unit vector; none: the normal of the side
};

/// A rigid round pin that pushes what it touches, in space a cylinder along z.
struct Pin {
  double radius = 0.0;    ///< [m]
  double stiffness = 0.0; ///< modulus of the layer between it and the body [Pa]
};

/// What acts on a named part of the body: `-bc_NAME_...`. The third component is that of solids.
struct BoundaryCondition {
  std::string name;
  std::string on;                                    ///< boundary of the mesh, "" if chosen by a box alone
  std::optional<geom::Box<2>> box;                   ///< only what lies in it [m]
  std::optional<Index> set;                          ///< only particles of it; clouds only
  std::string of;                                    ///< only a body of material points, "" for all
  std::array<std::optional<double>, 3> displacement; ///< held components [m]
  std::array<std::optional<double>, 3> velocity;     ///< the same, moved in time [m/s]
  std::optional<Vector<3>> initial_velocity;         ///< free afterwards [m/s]
  std::optional<field::History> history;             ///< of all but the initial velocity; none: constant
  std::optional<Vector<3>> traction;                 ///< [Pa]
  std::optional<Vector<3>> body;                     ///< [N/m^3]
  std::optional<Vector<3>> roller;                   ///< unit vector along which it is held, free across
  std::optional<Springs> springs;
  std::optional<double> turn;      ///< angle about `centre`, in space about the axis along z there [rad]
  std::optional<Vector<2>> centre; ///< [m]
  std::optional<Pin> pin;          ///< at `at`, moved by `displacement` and `velocity`
  std::optional<Vector<3>> force;  ///< at the node or particle nearest to `at`; of a cloud: in all, by volume [N]
  std::optional<Vector<2>> at;     ///< [m]
  int rows = 1;                    ///< particle rows under the boundary that take part
  bool layer = false;              ///< held particles in a layer of one horizon outside the body
  bool moves() const { return velocity[0] || velocity[1] || velocity[2]; }
  bool shifts() const { return displacement[0] || displacement[1] || displacement[2] || moves(); }
  bool holds() const { return !pin && (shifts() || roller || turn); }
  /// Is it held along a direction that is none of the axes?
  bool rolls_slanted() const { return roller && roller->cwiseAbs().maxCoeff() < 1.0 - 1e-15; }
  /// Does it keep the body from moving off?
  bool supports() const { return holds() || springs || pin; }
  /// Does it hold component a of what it chooses?
  bool holds(std::size_t a) const { return holds() && (displacement[a] || velocity[a] || turn || roller); }
};

/// All conditions of -bc_names, each judged by itself. @param young what a pin is as stiff as by default [Pa]
/// Throws UserError.
std::vector<BoundaryCondition> read_conditions(bool solid, double young, bool describe);
} // namespace pdx::options
