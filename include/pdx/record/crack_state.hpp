#pragma once
#include "pdx/scene/discretisation.hpp"

namespace pdx::record {
/// An end of a crack that was given, and what it has grown to since, whatever of it elements carry by now.
struct CrackEnd {
  crack::Tip given;
  crack::Polyline path;                     ///< from there to the tip as it is now; its start alone if nothing grew [m]
  Vector<2> direction = Vector<2>::UnitX(); ///< unit vector, straight on from there
  double grown = 0.0;                       ///< length of the path [m]
  /// Distances from the given tip along the path, and straight on behind it: the nearest intact bond that crosses it,
  /// infinity if there is none, and the farthest broken one [m].
  double first_intact = 0.0, farthest_broken = 0.0;

  Vector<2> tip() const { return path.back(); }
  /// Unit vector from the place that lies `length` behind the farthest broken bond, along the crack, to there.
  Vector<2> direction_over(double length) const;
  Vector<2> at_farthest() const; ///< where the farthest broken bond crosses [m]
  double angle_degrees() const;  ///< from the given direction to the way from the old tip to the new one; left positive
};

/// Where the cracks of a scene are now.
struct CrackState {
  std::vector<CrackEnd> ends; ///< one for each tip given
  double length = 0.0;        ///< of all cracks inside the body [m]
};

/// Before anything grows.
CrackState crack_state(const crack::CrackSet& given, const geom::Box<2>& body);
/// From the cracks as elements carry them, and from the bonds of the patches at their tips. Collective.
/// @param before of the same cracks: where two have grown together, each keeps what it had, and half of the rest
CrackState crack_state(const scene::Discretisation& d, const CrackState& before);

/// Length of a crack inside the body's box [m].
double length_inside(const crack::CrackSet& cracks, int crack, const geom::Box<2>& body);
/// From the crack's direction to the way from its old tip to the new one; left is positive.
double angle_degrees(const crack::Tip& from, const Vector<2>& to);
} // namespace pdx::record
