#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/geom/lattice.hpp"
#include "pdx/geom/line_pieces.hpp"
#include "pdx/pd/stencil.hpp"

#include <functional>
#include <unordered_map>

namespace pdx::track {
/// Particles of one lattice and which of their bonds are gone (broken or cut), alike on every rank.
class BondGraph {
public:
  /// @param has is there a particle at a site of the lattice (any integers, not only those within lattice.count)?
  BondGraph(const geom::Lattice<2>& lattice, const pd::Stencil<2>& stencil, std::function<bool(const Site<2>&)> has);

  /// @param gone bit h: the bond along half arm h of the stencil that begins at the site is gone (as
  /// pd::LatticePart::gone_of). Sites that are not added have lost none.
  void add(const Site<2>& site, const std::array<std::uint64_t, 2>& gone);

  const geom::Lattice<2>& lattice() const { return lattice_; }
  const pd::Stencil<2>& stencil() const { return stencil_; }
  double horizon() const { return stencil_.horizon; }                         ///< [m]
  Vector<2> point(const Site<2>& site) const { return lattice_.point(site); } ///< [m]
  bool has(const Site<2>& site) const { return has_(site); }                  ///< is there a particle?
  Site<2> end_of(const Site<2>& site, std::size_t arm) const;                 ///< where half arm `arm` leads
  /// Was there a bond along half arm `arm` from the site? Both ends are particles, and what is between them is too.
  bool begins(const Site<2>& site, std::size_t arm) const;
  /// Did the site lose the bond along half arm `arm`?
  bool gone(const Site<2>& site, std::size_t arm) const;
  bool intact(const Site<2>& site, std::size_t arm) const { return !gone(site, arm) && begins(site, arm); }

private:
  geom::Lattice<2> lattice_;
  pd::Stencil<2> stencil_;
  std::function<bool(const Site<2>&)> has_;
  std::vector<std::vector<geom::LinePiece<2>>> lines_; // per half arm
  std::unordered_map<std::uint64_t, std::array<std::uint64_t, 2>> gone_;
};

/// The particles of a box as bodies that intact bonds within the box hold together.
struct Bodies {
  std::vector<Site<2>> sites; ///< in order of rows
  std::vector<int> body;      ///< of each site, numbered by the first site
  int count = 0;
};
/// @param window [m]; particles on its border count, to a millionth of a spacing
Bodies bodies_in(const BondGraph& graph, const geom::Box<2>& window);

/// Are the bodies exactly the sides that `side_of` says (a body per side, no body on two sides)?
/// @param side_of     number of the side of a point [m]
/// @param distance_of distance of a point from the nearest line between sides [m]
/// @param slack       particles nearer to a line than that may lie on the wrong side [m]. A body of at most five
///                    particles, none farther than that and a spacing from a line, is crumbs and does not count.
bool are_sides(const Bodies& bodies, const BondGraph& graph, const std::function<int(const Vector<2>&)>& side_of,
               const std::function<double(const Vector<2>&)>& distance_of, double slack);

/// Bodies of at most so many particles may be crumbs.
inline constexpr int kCrumbs = 5;
} // namespace pdx::track
