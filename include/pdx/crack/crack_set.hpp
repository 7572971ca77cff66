#pragma once
#include "pdx/geom/box.hpp"

#include <functional>
#include <span>
#include <vector>

namespace pdx::crack {
/// A crack: straight pieces from point to point.                                   [m]
using Polyline = std::vector<Vector<2>>;
/// True for points inside the body and not on its surface.
using Inside = std::function<bool(const Vector<2>&)>;

/// An end of a crack inside the body.
struct Tip {
  int crack = 0;                            ///< number of its crack
  bool last = false;                        ///< the crack's last point, else its first
  Vector<2> at = Vector<2>::Zero();         ///< [m]
  Vector<2> direction = Vector<2>::UnitX(); ///< unit vector out of the crack, the way it would grow on
};

/// An end of a crack on another crack.
struct Junction {
  int crack = 0, other = 0;         ///< number of the crack that ends, and of the one it ends on
  Vector<2> at = Vector<2>::Zero(); ///< [m]
};

/// The cracks of a scene, and every question about where they are. In space they reach through the thickness: only x
/// and y of a point matter.
///
/// Left of a crack (looking from its first to its last point) is its + side. A point on the crack, or on its straight
/// prolongation, counts as left, in spite of rounding: the crack parts things where it would be if shifted to its right
/// by 1e-13 of the body's size. All signs come from exact predicates, so that they are the same from either end of a
/// bond and on every rank.
class CrackSet {
public:
  CrackSet() = default;
  /// Ends inside the box are tips. Ends on its surface, to 1e-9 of its size, are mouths: the crack is seen as going on
  /// straight for 1e-3 of the box's size, so that rounding leaves no skin. An end on another crack, to 1e-9 of the
  /// box's size, is no tip but a junction, and goes on for twice that. Throws UserError for a crack with fewer than two
  /// points, equal neighbouring points, a point that is not finite, or one that turns back on or crosses itself, and
  /// for two cracks that run along each other.
  CrackSet(std::vector<Polyline> cracks, const geom::Box<2>& body);
  /// As above for any body; a crack with an end that is not inside is prolonged there by `prolong` [m], unless that
  /// comes to lie inside again.
  CrackSet(std::vector<Polyline> cracks, const Inside& inside, double prolong);

  int size() const { return static_cast<int>(cracks_.size()); }
  bool empty() const { return cracks_.empty(); }
  const Polyline& points(int crack) const { return cracks_[static_cast<std::size_t>(crack)].given; } ///< as given
  /// The same with mouths, and ends on other cracks, prolonged.
  const Polyline& seen(int crack) const { return cracks_[static_cast<std::size_t>(crack)].seen; }
  std::span<const Tip> tips() const { return tips_; }
  std::span<const Junction> junctions() const { return junctions_; }
  double length(int crack) const; ///< as given [m]

  /// +1 left of the crack and on it, -1 right; never 0. Beyond an end: of its straight prolongation.
  int side(int crack, const Vector<2>& x) const;
  /// Distance from the crack times `side`; beyond an end, from its straight prolongation.       [m]
  double signed_distance(int crack, const Vector<2>& x) const;
  /// How far x is beyond the nearest end of the crack, along the crack's direction there; 0 beside the crack. [m]
  double beyond(int crack, const Vector<2>& x) const;

  /// Does the crack part the straight bond from a to b: does the bond change sides anywhere on its way? A bond that
  /// meets a tip (to 1e-12 of the body's size) stays, as does one that touches a corner from outside on its left, or
  /// runs along the crack; one through an inner corner from side to side is cut. The same for (b, a).
  bool cuts(int crack, const Vector<2>& a, const Vector<2>& b) const;
  bool cuts(const Vector<2>& a, const Vector<2>& b) const; ///< by any crack
  /// May a bond with an end at x, at most `reach` [m] long, be cut by any crack? Quick, and true rather too often.
  bool near(const Vector<2>& x, double reach) const;

private:
  struct Crack {
    Polyline given, seen; ///< seen: mouths prolonged
    Polyline parting;     ///< seen, shifted: all decisions on sides
    geom::Box<2> bounds;  ///< of parting
    Polyline tips;        ///< ends inside the body
    Polyline withdrawn;   ///< as seen by bonds that meet a tip: tips drawn back by more than rounding
    double tip_reach;     ///< a bond that passes a tip this near meets it [m]
  };
  struct Foot;
  static Foot foot(const Polyline& line, const Vector<2>& x);
  using Joins = std::function<int(const Vector<2>&)>; // number of the crack that an end lies on, -1: none
  void add(const Polyline& points, const Inside& inside, double prolong, const Joins& joins);

  std::vector<Crack> cracks_;
  std::vector<Tip> tips_;
  std::vector<Junction> junctions_;
};
} // namespace pdx::crack
