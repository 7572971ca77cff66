#pragma once
#include "pdx/base/processor.hpp"
#include "pdx/mpm/body_material.hpp"
#include "pdx/mpm/grid_rule.hpp"
#include "pdx/mpm/point_lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

/// What points and nodes of a grid that is fixed in space hand to each other, lanes of cells at a time.
namespace pdx::mpm {
/// Numbers on a box of nodes, x fastest, one list for each number: sums first, then what is made of them in place.
template <int Dim> struct NodeView {
  Site<Dim> lower{};                      ///< number of the first node
  std::array<std::ptrdiff_t, Dim> step{}; ///< from a node to the next along each axis; 1 along x
  double* mass = nullptr;                 ///< [kg]
  std::array<double*, Dim> velocity{};    ///< sum of momenta [kg m/s], then [m/s]
  std::array<double*, Dim> pull{};        ///< sum of forces [N], then acceleration [m/s^2]
  std::array<double*, Dim> brought{};     ///< sum of the momenta of points that were moved, then velocity
};

/// Blocks of points from one to before another.
struct SomeBlocks {
  std::size_t from = 0, to = std::numeric_limits<std::size_t>::max();
  template <class Block> std::span<Block> of(std::span<Block> all) const
  {
    return all.subspan(from, std::min(to, all.size()) - from);
  }
};

/// What points give to nodes.
struct Giving {
  bool momentum = false; ///< with mass
  bool force = false;    ///< internal, and `push` of each point
  SomeBlocks blocks{};   ///< whose points
};

/// What points take from nodes, in this order.
struct Taking {
  bool velocity = false; ///< by the nodes' acceleration
  bool giving = false;   ///< give the new momentum to `brought` at once
  bool strain = false;   ///< F, by the gradient of the nodes' velocity
  bool place = false;    ///< by the nodes' velocity
  bool brought = false;  ///< for the last two: the velocity in `brought`
  double step = 0.0;     ///< of strain and place [s]
  double kick = 0.0;     ///< of velocity [s]
  SomeBlocks blocks{};   ///< whose points
};

/// Any of these that kernels are made for: {momentum, force}, {momentum}, {force}.
/// @param push force on each point besides [N]
template <int Dim>
void give(Processor processor, const GridRule& rule, const BodyMaterial& body, const Giving& what,
          const Vector<Dim>& push, const PointLanes<Dim>& points, const NodeView<Dim>& nodes);
/// {velocity, giving}, {velocity, giving, place}, {velocity, strain, place}, {velocity, place}, {strain, place},
/// {strain}. Points that are in another cell then have their block marked.
/// @return how far all points have moved, added up [m]
template <int Dim>
Vector<Dim> take(Processor processor, const GridRule& rule, const BodyMaterial& body, const Taking& what,
                 PointLanes<Dim>& points, const NodeView<Dim>& nodes);
/// Momenta into velocities, forces into accelerations, and velocities on by these. A node without mass has none.
/// @param mass as many as there are nodes, a multiple of 8   @param point mass of a point [kg]
/// @param momentum, force null where there are none   @param is_velocity `momentum` has been made one before
/// @param spare a small mass gets no velocity from a force: points see next to nothing of it but its gradient
void settle_nodes(Processor processor, std::span<const double> mass, double point, double step, double* momentum,
                  double* force, bool is_velocity = false, bool spare = false);
/// Strain and kinetic energy of all points [J].
struct PointEnergies {
  double strain = 0.0, kinetic = 0.0;
};
template <int Dim>
PointEnergies energies_of(Processor processor, const BodyMaterial& body, const PointLanes<Dim>& points);
} // namespace pdx::mpm
