#pragma once
#include "pdx/pd/surface.hpp"

#include <algorithm>
#include <utility>

namespace pdx::pd::free_sides {
template <int Dim> Site<Dim> shifted(Site<Dim> site, const Site<Dim>& step, Index times)
{
  for (std::size_t d = 0; d < Dim; ++d) site[d] += times * step[d];
  return site;
}

/// A number for every site of a box, `initial` outside.
template <int Dim, class T> class SiteMap {
public:
  SiteMap(Site<Dim> lower, const Site<Dim>& extent, Index margin, T initial) : initial_(initial)
  {
    std::size_t size = 1;
    for (std::size_t d = 0; d < Dim; ++d) {
      lower_[d] = lower[d] - margin;
      extent_[d] = extent[d] > 0 ? extent[d] + 2 * margin : 0;
      size *= static_cast<std::size_t>(extent_[d]);
    }
    values_.assign(size, initial);
  }
  bool holds(const Site<Dim>& site) const
  {
    for (std::size_t d = 0; d < Dim; ++d)
      if (site[d] < lower_[d] || site[d] >= lower_[d] + extent_[d]) return false;
    return true;
  }
  T& operator[](const Site<Dim>& site) { return values_[place(site)]; }
  const Site<Dim>& lower() const { return lower_; }
  const Site<Dim>& extent() const { return extent_; }
  /// Within the box.
  void fill(T value) { std::ranges::fill(values_, value); }
  /// Of each site and those up to `width` away in every direction, what all have, bit by bit; outside the box all is
  /// set.
  SiteMap common(Index width) const
  {
    SiteMap result = *this;
    std::size_t stride = 1;
    for (std::size_t d = 0; d < Dim; ++d) {
      const std::vector<T> before = result.values_;
      const std::size_t line = stride * static_cast<std::size_t>(extent_[d]);
      for (Index k = 1; k <= std::min(width, extent_[d] - 1); ++k) {
        const std::size_t shift = static_cast<std::size_t>(k) * stride;
        for (std::size_t first = 0; first < before.size(); first += line)
          for (std::size_t i = first; i + shift < first + line; ++i) {
            result.values_[i] &= before[i + shift];
            result.values_[i + shift] &= before[i];
          }
      }
      stride = line;
    }
    return result;
  }
  T at(const Site<Dim>& site) const { return holds(site) ? values_[place(site)] : initial_; }

private:
  std::size_t place(const Site<Dim>& site) const
  {
    std::size_t at = 0;
    for (std::size_t d = Dim; d-- > 0;)
      at = at * static_cast<std::size_t>(extent_[d]) + static_cast<std::size_t>(site[d] - lower_[d]);
    return at;
  }
  Site<Dim> lower_{}, extent_{};
  T initial_;
  std::vector<T> values_;
};

/// Sites along x from which no side is near: neither the border of a set nor a crack.
template <int Dim> class FarRuns {
public:
  /// @param far  sites far from the border   @param reach  of cracks, in spacings
  FarRuns(geom::SiteSet<Dim> far, const geom::Lattice<Dim>& lattice, const crack::CrackSet* cracks, Index reach)
      : far_(std::move(far)), lattice_(lattice), cracks_(cracks && !cracks->empty() ? cracks : nullptr), reach_(reach)
  {}
  bool has(const Site<Dim>& site) const { return far_.has(site) && !beside_crack(site); }
  bool beside_crack(const Site<Dim>& site) const
  {
    return cracks_ && cracks_->near(lattice_.point(site).template head<2>(), reach_ * lattice_.dx);
  }
  /// x after the run that begins at a site, its own where that is not far.
  Index end(Site<Dim> site) const
  {
    if (!far_.has(site)) return site[0];
    const Index end = far_.end_of_run(site);
    while (cracks_ && site[0] < end) {
      constexpr Index chunk = 32;
      const Index length = std::min(chunk, end - site[0]);
      Vector<2> middle = lattice_.point(site).template head<2>();
      middle[0] += 0.5 * (length - 1) * lattice_.dx;
      if (!cracks_->near(middle, (reach_ + 0.5 * length) * lattice_.dx)) {
        site[0] += length;
        continue;
      }
      for (Index k = 0; k < length; ++k, ++site[0])
        if (!has(site)) return site[0];
    }
    return end;
  }

private:
  geom::SiteSet<Dim> far_;
  geom::Lattice<Dim> lattice_;
  const crack::CrackSet* cracks_;
  Index reach_;
};

/// Calls visit(site) for each site of a box, in order.
template <int Dim, class Visit> void for_each_site(const Site<Dim>& lower, const Site<Dim>& extent, Visit&& visit)
{
  if (std::ranges::any_of(extent, [](Index n) { return n <= 0; })) return;
  for (Site<Dim> site = lower;;) {
    visit(std::as_const(site));
    std::size_t d = 0;
    for (; d < Dim && ++site[d] == lower[d] + extent[d]; ++d) site[d] = lower[d];
    if (d == Dim) return;
  }
}

/// Rows (layers) from a window's sites to the free sides around them. A way is an axis and a direction along it: down
/// or up it.
template <int Dim> class Sides {
public:
  static constexpr std::size_t kWays = 2 * Dim;

  /// @param reach of bonds: nearer sides have factors   @param sight how far one looks for a side
  Sides(const Exists<Dim>& exists, const crack::CrackSet* cracks, int reach, int sight, const WindowSites<Dim>& window)
      : reach_(reach), sight_(static_cast<std::uint8_t>(sight)), lattice_(window.lattice),
        inside_(window.sites().eroded(reach), window.lattice, cracks, reach + 1), cracks_(cracks),
        there_(window.lower, window.extent, reach + sight, 0), beside_(there_), bonded_(there_)
  {
    std::vector<Site<Dim>> near = sites_near_border();
    there_.fill(1);
    for (const Site<Dim>& site : near) there_[site] = exists(site);
    const Map amid = there_.common(reach);
    std::erase_if(near, [&](const Site<Dim>& site) { return amid.at(site) && !inside_.beside_crack(site); });
    for (std::size_t way = 0; way < kWays; ++way) {
      Map depth(window.lower, window.extent, reach + sight, sight_);
      depth.fill(sight_);
      for (const Site<Dim>& site : near) depth[site] = look(site, way);
      straight_.push_back(depth);
      for (const Site<Dim>& site : near) {
        straight_[way][site] = straighten(depth, site, way);
        if (straight_[way].at(site) < reach_) beside_[site] = 1;
      }
    }
    for (const Site<Dim>& site : near)
      if (beside_.at(site)) mark_around(site);
  }

  /// Rows between the site and the straight side that way, `sight` where there is none so near.
  int rows(const Site<Dim>& site, std::size_t way) const { return straight_[way].at(site); }
  /// Rows between both sides along an axis, 0 where at least one is not so near.
  int rows_across(const Site<Dim>& site, std::size_t axis) const
  {
    const int down = rows(site, 2 * axis), up = rows(site, 2 * axis + 1);
    return down < sight_ && up < sight_ ? down + up + 1 : 0;
  }
  /// Is any straight side nearer than a reach?
  bool beside(const Site<Dim>& site) const { return beside_.at(site); }
  /// May the site have a bond that begins or ends beside a side?
  bool bonded(const Site<Dim>& site) const { return bonded_.at(site); }
  /// x after the sites that have none, from this one on.
  Index end_of_plain(Site<Dim> site) const
  {
    const Index end = bonded_.lower()[0] + bonded_.extent()[0];
    while (site[0] < end && !bonded_.at(site)) ++site[0];
    return site[0];
  }

private:
  using Map = SiteMap<Dim, std::uint8_t>;
  static Site<Dim> next(Site<Dim> site, std::size_t way)
  {
    site[way / 2] += way % 2 ? 1 : -1;
    return site;
  }

  /// May one go from a site to the next that way?
  bool open(const Site<Dim>& site, std::size_t way) const
  {
    const Site<Dim> beyond = next(site, way);
    if (!there_.holds(beyond)) return true; // nobody asks what is so far away
    if (!there_.at(beyond)) return false;
    if (!cracks_ || cracks_->empty()) return true;
    const Vector<2> x = lattice_.point(site).template head<2>();
    return !cracks_->near(x, lattice_.dx) || !cracks_->cuts(x, lattice_.point(beyond).template head<2>());
  }

  void mark_around(const Site<Dim>& site)
  {
    Site<Dim> lower = site, extent{};
    for (std::size_t d = 0; d < Dim; ++d) {
      lower[d] -= reach_;
      extent[d] = 2 * reach_ + 1;
    }
    for_each_site<Dim>(lower, extent, [&](const Site<Dim>& at) {
      if (bonded_.holds(at)) bonded_[at] = 1;
    });
  }

  /// All but those so far inside that no side is near.
  std::vector<Site<Dim>> sites_near_border() const
  {
    std::vector<Site<Dim>> near;
    const Site<Dim>& lower = there_.lower();
    Site<Dim> lines = there_.extent();
    const Index end_of_line = lower[0] + lines[0];
    lines[0] = std::min(lines[0], 1);
    for_each_site<Dim>(lower, lines, [&](Site<Dim> site) {
      while (site[0] < end_of_line) {
        const Index end = inside_.end(site);
        if (end == site[0]) {
          near.push_back(site);
          ++site[0];
        }
        site[0] = std::max(site[0], end);
      }
    });
    return near;
  }

  std::uint8_t look(Site<Dim> site, std::size_t way) const
  {
    if (!there_.at(site)) return sight_;
    for (std::uint8_t rows = 0; rows < sight_; ++rows, site = next(site, way))
      if (!open(site, way)) return rows;
    return sight_;
  }

  /// The depth of a site that all have which hang together with it along the side, up to a reach away in each
  /// direction.
  std::uint8_t straighten(const Map& depth, const Site<Dim>& site, std::size_t way) const
  {
    const std::uint8_t rows = depth.at(site);
    if (rows == sight_) return sight_;
    bool alike = true;
    const auto look_along = [&](const Site<Dim>& from, std::size_t along, auto&& visit) {
      Site<Dim> at = from;
      for (int k = 0; alike && k < reach_ && open(at, along); ++k) {
        at = next(at, along);
        alike = depth.at(at) == rows;
        visit(at);
      }
    };
    for (std::size_t along = 0; along < kWays; ++along) {
      if (along / 2 == way / 2) continue;
      look_along(site, along, [&](const Site<Dim>& beside) {
        for (std::size_t further = 0; further < kWays; ++further)
          if (further / 2 != way / 2 && further / 2 != along / 2) look_along(beside, further, [](const Site<Dim>&) {});
      });
    }
    return alike ? rows : sight_;
  }

  int reach_;
  std::uint8_t sight_;
  geom::Lattice<Dim> lattice_;
  FarRuns<Dim> inside_;
  const crack::CrackSet* cracks_;
  Map there_;
  std::vector<Map> straight_; ///< by way
  Map beside_, bonded_;
};
} // namespace pdx::pd::free_sides
