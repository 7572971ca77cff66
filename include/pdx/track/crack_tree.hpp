#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/geom/site_names.hpp"
#include "pdx/geom/site_set.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace pdx::track {
/// A particle that damage has reached, and when.
struct Arrival {
  std::uint64_t site = 0; ///< its name (TreeGround::names)
  double time = 0.0;      ///< [s]
};

/// Where a crack grows from: a tip that was given.
struct CrackStart {
  Vector<2> at = Vector<2>::Zero();         ///< [m]
  Vector<2> direction = Vector<2>::UnitX(); ///< unit vector, straight on
};

/// A lattice as the tree sees it. Particles may come and go on it; names and places of its sites stay.
struct TreeGround {
  geom::ActiveLattice<2> where; ///< its active sites are those that particles lay on first: there starts are looked for
  double horizon = 0.0;         ///< [m]
  geom::SiteNames names;        ///< of sites as `where` counts them
};

/// When damage came by, and where.
struct PathPoint {
  double time = 0.0;                ///< [s]
  Vector<2> at = Vector<2>::Zero(); ///< [m]
};

/// A tip as it is now. The path begins at the start, or for a branch too: paths of branches share their beginning.
struct GrownTip {
  std::size_t start = 0;       ///< number of the start it grew from
  double length = 0.0;         ///< grown, along the path from the start; 0 if it did not grow [m]
  double own = 0.0;            ///< the same, from where it left a longer branch [m]
  std::vector<PathPoint> path; ///< from the start to the tip; empty if it did not grow
  Vector<2> at = Vector<2>::Zero();
  std::optional<PathPoint> branched; ///< where it left a longer branch, and when the first of both was as far
};

/// The cracks that grow from given starts, as a tree over the particles that damage has reached, in order of time. Each
/// particle knows how far from its start it is, along a chain of damaged neighbours. Tips are those farther than all
/// others around: a shorter branch counts once it goes two horizons beyond where it and a longer one part. Damage that
/// hangs together with no start is kept aside until it does.
/// What is equally far, to 1e-6 of a spacing, is treated alike and averaged, so that nothing hangs on rounding, on the
/// order of particles or on which way the scene is turned.
class CrackTree {
public:
  /// Starts outside all grounds stay where they are. @param grounds one per lattice
  CrackTree(std::vector<CrackStart> starts, std::vector<TreeGround> grounds);

  /// Particles that were not added before, in any order, none earlier than the last ones by more than a look.
  void add(std::vector<Arrival> arrivals);
  std::span<const Arrival> arrivals() const { return arrivals_; } ///< all that were added
  bool has(std::uint64_t site) const { return point_of_.contains(site); }
  std::optional<Vector<2>> place(std::uint64_t site) const; ///< none if no lattice has a site of that name [m]

  std::vector<GrownTip> tips() const; ///< of each start the longest first, at least one
  /// Four horizons of the ground that a start is in, 0 outside: over which speeds are taken. [m]
  double span(std::size_t start) const;
  /// When damage first was next to a start; none if nothing grew. [s]
  std::optional<double> start_time() const { return start_time_; }

private:
  struct Point {
    Vector<2> at;
    double time = 0.0;
    double distance = 0.0; ///< from the start, along the chain [m]
    int start = -1;
    std::vector<int> parents; ///< all through which it is as near
    std::vector<int> near;    ///< damaged neighbours
  };
  /// Points that are as far as each other and hang together: what is to be a tip.
  struct Front {
    std::vector<int> points;
    double distance = 0.0, time = 0.0; ///< time of the first [m], [s]
  };
  /// All shortest chains to a front at once: what is as far as each other counts as one, in the middle.
  struct Way {
    std::vector<double> distance; ///< falling [m]
    std::vector<PathPoint> path;
  };
  /// A branch as it meets a longer one.
  struct Meeting {
    const Front &branch, &longer;
    std::vector<int> points; ///< where, equally far
  };
  class Groups;
  struct Seat {
    const TreeGround* ground;
    Site<2> site;
  };
  std::optional<Seat> seat(std::uint64_t site) const;
  double equal(const Point& point) const; ///< distances this near are equal [m]
  int insert(const Arrival& arrival);
  void seed(Point& point, const TreeGround& ground);
  void link(const std::vector<int>& open);
  std::vector<std::vector<int>> farthest_first(int start) const;
  bool beats(const Front& a, const Front& b) const;
  PathPoint middle(std::span<const int> points) const;
  Way way_to(const Front& front) const;
  double passed(const Front& front, double distance) const;
  GrownTip tip_at(const Front& front) const;
  GrownTip branch_at(const Meeting& meeting) const;
  std::vector<GrownTip> tips_of(int start) const;

  std::vector<CrackStart> starts_;
  std::vector<int> start_ground_; // of each start, -1 outside
  std::vector<TreeGround> grounds_;
  std::vector<Arrival> arrivals_;
  std::vector<Point> points_; // in order of arrivals_
  std::vector<int> loose_;    // points that hang together with no start
  std::unordered_map<std::uint64_t, int> point_of_;
  std::optional<double> start_time_;
};

/// Speed of a tip: the slope of its way over time, least squares over the last four horizons of the path, so that jumps
/// from particle to particle average out; 0 before it has grown as far. A tip that waits for longer than a look slows
/// down to what it would have if it went on now.
/// @param span four horizons [m]  @param now, look: time, and time between looks [s]
double tip_speed(const GrownTip& tip, double span, double now, double look);
} // namespace pdx::track
