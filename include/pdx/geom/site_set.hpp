#pragma once
#include "pdx/geom/lattice.hpp"

#include <span>
#include <utility>
#include <vector>

namespace pdx::geom {
/// Active sites one after the other along x.
template <int Dim> struct SiteRun {
  Site<Dim> first{};
  Index length = 0;
  std::int64_t place = 0; ///< active sites before `first`
};

/// The active sites of a lattice, of any shape; a value type. Their place is their number among them, x fastest: that
/// of the lattice itself where all its sites are active.
template <int Dim> class SiteSet {
public:
  using Corners = std::pair<Site<Dim>, Site<Dim>>; ///< sites [first, second) of a box

  SiteSet() = default; ///< no site
  explicit SiteSet(const Corners& box) : SiteSet(std::span(&box, 1)) {}
  explicit SiteSet(std::span<const Corners> boxes); ///< what lies in any of the boxes
  explicit SiteSet(const Lattice<Dim>& whole) : SiteSet(Corners{Site<Dim>{}, whole.count}) {}

  bool has(const Site<Dim>& site) const
  {
    for (std::size_t d = 0; d < Dim; ++d)
      if (site[d] < lower_[d] || site[d] >= upper_[d]) return false;
    return box_ || has_[bit(site)];
  }
  bool has_all(const Corners& box) const;
  std::int64_t size() const { return size_; }
  bool is_box() const { return box_; }
  const Site<Dim>& lower() const { return lower_; } ///< of the box around the set
  const Site<Dim>& upper() const { return upper_; }

  std::int64_t place(const Site<Dim>& site) const; ///< of an active site
  Site<Dim> site(std::int64_t place) const;        ///< inverse of `place` on [0, size())
  Index end_of_run(const Site<Dim>& site) const;   ///< x after the run that holds an active site
  std::vector<SiteRun<Dim>> runs() const;

  /// The sites whose neighbours up to `width` away in every direction are all active.
  SiteSet eroded(Index width) const;
  /// The sites with an active one up to `width` away in every direction.
  SiteSet grown(Index width) const;

private:
  using Interval = std::pair<Index, Index>; // [first, second) along x
  using Rows = std::vector<std::vector<Interval>>;
  SiteSet(const Site<Dim>& lower, const Site<Dim>& upper, Rows rows);
  std::size_t row(const Site<Dim>& site) const
  {
    std::size_t r = 0;
    for (std::size_t d = Dim - 1; d > 0; --d)
      r = r * static_cast<std::size_t>(upper_[d] - lower_[d]) + static_cast<std::size_t>(site[d] - lower_[d]);
    return r;
  }
  std::size_t bit(const Site<Dim>& site) const
  {
    return row(site) * static_cast<std::size_t>(upper_[0] - lower_[0]) + static_cast<std::size_t>(site[0] - lower_[0]);
  }
  Site<Dim> row_start(std::size_t row) const;
  std::span<const SiteRun<Dim>> runs_of(std::size_t row) const;
  const SiteRun<Dim>* run_at(const Site<Dim>& site) const;
  SiteSet stretched(Index width, bool grow) const;

  Site<Dim> lower_{}, upper_{};
  std::int64_t size_ = 0;
  bool box_ = true;                // all sites between lower and upper; then there are no runs
  std::vector<SiteRun<Dim>> runs_; // by row
  std::vector<std::size_t> first_; // run of each row, and the end
  std::vector<bool> has_;          // by place in the box around it
};

/// A lattice and which of its sites are active: all of them, where none are named. A value type.
template <int Dim> struct ActiveLattice {
  ActiveLattice(const Lattice<Dim>& whole) : ActiveLattice(whole, SiteSet<Dim>(whole)) {}
  ActiveLattice(const Lattice<Dim>& of, SiteSet<Dim> sites) : lattice(of), active(std::move(sites)) {}
  Lattice<Dim> lattice;
  SiteSet<Dim> active;
};

/// A straight piece of the border of a set, along the lattice line `at` across `axis` from line `from` to line `to`:
/// line k runs before the sites k. `upper`: the set lies below it.
struct StraightSide {
  std::size_t axis = 0;
  bool upper = false;
  Index at = 0, from = 0, to = 0;
};
/// The whole border: axis 0 first, lower sides before upper ones, then ascending. Pieces that meet are one.
std::vector<StraightSide> straight_sides(const SiteSet<2>& set);

/// True if x is no further than `margin` [m] from the cell of an active site.
bool covers(const ActiveLattice<2>& where, const Vector<2>& x, double margin);
} // namespace pdx::geom
