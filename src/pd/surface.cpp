#include "pdx/pd/surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

namespace pdx::pd {
namespace {
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
class FarRuns {
public:
  /// @param far  sites far from the border   @param reach  of cracks, in spacings
  FarRuns(geom::SiteSet<2> far, const geom::Lattice<2>& lattice, const crack::CrackSet* cracks, Index reach)
      : far_(std::move(far)), lattice_(lattice), cracks_(cracks && !cracks->empty() ? cracks : nullptr), reach_(reach)
  {}
  bool has(const Site<2>& site) const { return far_.has(site) && !beside_crack(site); }
  bool beside_crack(const Site<2>& site) const
  {
    return cracks_ && cracks_->near(lattice_.point(site), reach_ * lattice_.dx);
  }
  /// x after the run that begins at a site, its own where that is not far.
  Index end(Site<2> site) const
  {
    if (!far_.has(site)) return site[0];
    const Index end = far_.end_of_run(site);
    while (cracks_ && site[0] < end) {
      constexpr Index chunk = 32;
      const Index length = std::min(chunk, end - site[0]);
      Vector<2> middle = lattice_.point(site);
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
  geom::SiteSet<2> far_;
  geom::Lattice<2> lattice_;
  const crack::CrackSet* cracks_;
  Index reach_;
};

/// Rows from a window's sites to the free sides around them.
class Sides {
public:
  /// Down, up, left, right.
  static constexpr std::size_t kWays = 4;

  Sides(const Exists<2>& exists, const crack::CrackSet* cracks, int reach, const WindowSites<2>& window)
      : reach_(static_cast<std::uint8_t>(reach)), lattice_(window.lattice),
        inside_(window.sites().eroded(reach), window.lattice, cracks, reach + 1), cracks_(cracks),
        there_(window.lower, window.extent, 2 * reach, 0), depth_{Map(window.lower, window.extent, 2 * reach, reach_),
                                                                  Map(window.lower, window.extent, 2 * reach, reach_),
                                                                  Map(window.lower, window.extent, 2 * reach, reach_),
                                                                  Map(window.lower, window.extent, 2 * reach, reach_)},
        straight_(depth_), beside_(window.lower, window.extent, 2 * reach, 0), bonded_(beside_)
  {
    std::vector<Site<2>> near = sites_near_border();
    there_.fill(1);
    for (const Site<2>& site : near) there_[site] = exists(site);
    const Map amid = there_.common(reach);
    std::erase_if(near, [&](const Site<2>& site) { return amid.at(site) && !inside_.beside_crack(site); });
    for (std::size_t way = 0; way < kWays; ++way) {
      for (const Site<2>& site : near) depth_[way][site] = look(site, way);
      for (const Site<2>& site : near) {
        straight_[way][site] = straighten(site, way);
        if (straight_[way].at(site) < reach_) beside_[site] = 1;
      }
    }
    for (const Site<2>& site : near)
      if (beside_.at(site)) mark_around(site);
  }

  /// Rows between the site and the straight side that way, `reach` where there is none so near.
  int rows(const Site<2>& site, std::size_t way) const { return straight_[way].at(site); }
  /// Is any straight side nearer than a reach?
  bool beside(const Site<2>& site) const { return beside_.at(site); }
  /// May the site have a bond that begins or ends beside a side?
  bool bonded(const Site<2>& site) const { return bonded_.at(site); }
  /// x after the sites that have none, from this one on.
  Index end_of_plain(Site<2> site) const
  {
    const Index end = bonded_.lower()[0] + bonded_.extent()[0];
    while (site[0] < end && !bonded_.at(site)) ++site[0];
    return site[0];
  }

private:
  using Map = SiteMap<2, std::uint8_t>;
  static Site<2> step(std::size_t way) { return std::array<Site<2>, 4>{{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}}[way]; }

  /// May one go from a site to the next that way?
  bool open(const Site<2>& site, std::size_t way) const
  {
    const Site<2> next = shifted<2>(site, step(way), 1);
    if (!there_.holds(next)) return true; // nobody asks what is so far away
    if (!there_.at(next)) return false;
    if (!cracks_ || cracks_->empty()) return true;
    const Vector<2> x = lattice_.point(site);
    return !cracks_->near(x, lattice_.dx) || !cracks_->cuts(x, lattice_.point(next));
  }

  void mark_around(const Site<2>& site)
  {
    for (Site<2> at{0, site[1] - reach_}; at[1] <= site[1] + reach_; ++at[1])
      for (at[0] = site[0] - reach_; at[0] <= site[0] + reach_; ++at[0])
        if (bonded_.holds(at)) bonded_[at] = 1;
  }

  /// All but those so far inside that no side is near.
  std::vector<Site<2>> sites_near_border() const
  {
    std::vector<Site<2>> near;
    const Site<2>&lower = there_.lower(), &extent = there_.extent();
    for (Site<2> site{0, lower[1]}; site[1] < lower[1] + extent[1]; ++site[1])
      for (site[0] = lower[0]; site[0] < lower[0] + extent[0];) {
        const Index end = inside_.end(site);
        if (end == site[0]) {
          near.push_back(site);
          ++site[0];
        }
        site[0] = std::max(site[0], end);
      }
    return near;
  }

  std::uint8_t look(Site<2> site, std::size_t way) const
  {
    if (!there_.at(site)) return reach_;
    for (std::uint8_t rows = 0; rows < reach_; ++rows, site = shifted<2>(site, step(way), 1))
      if (!open(site, way)) return rows;
    return reach_;
  }

  std::uint8_t straighten(const Site<2>& site, std::size_t way) const
  {
    const std::uint8_t depth = depth_[way].at(site);
    if (depth == reach_) return reach_;
    for (const std::size_t along : way < 2 ? std::array<std::size_t, 2>{2, 3} : std::array<std::size_t, 2>{0, 1}) {
      Site<2> next = site;
      for (int k = 0; k < reach_ && open(next, along); ++k) {
        next = shifted<2>(next, step(along), 1);
        if (depth_[way].at(next) != depth) return reach_;
      }
    }
    return depth;
  }

  std::uint8_t reach_;
  geom::Lattice<2> lattice_;
  FarRuns inside_;
  const crack::CrackSet* cracks_;
  Map there_;
  std::array<Map, kWays> depth_, straight_;
  Map beside_, bonded_;
};

/// The factor that the sides on one way give to the bond from i to j, which spans `across` rows that way. Ends in one
/// row see the same side, unless it ends between them.
double towards(const SideWeights& weights, const Sides& sides, std::size_t way, const Site<2>& nearer,
               const Site<2>& further, int along, int across)
{
  const double factor = weights.at(sides.rows(nearer, way), along, across);
  return across ? factor : 0.5 * (factor + weights.at(sides.rows(further, way), along, across));
}
} // namespace

template <int Dim> int family_reach(const Stencil<Dim>& stencil)
{
  int reach = 0;
  for (const auto* arms : {&stencil.half, &stencil.mute})
    for (const Arm<Dim>& arm : *arms)
      for (const Index step : arm.step) reach = std::max(reach, std::abs(step));
  return reach;
}

template <int Dim> double family_share(const Stencil<Dim>& stencil, const Site<Dim>& site, const Exists<Dim>& exists)
{
  double missing = 0.0;
  for (const auto* arms : {&stencil.half, &stencil.mute})
    for (const Arm<Dim>& arm : *arms)
      for (const Index sign : {1, -1})
        if (!exists(shifted<Dim>(site, arm.step, sign))) missing += arm.volume_share;
  return 1.0 - missing * stencil.volume() / stencil.family_volume_full();
}

namespace {
/// Family shares, worked out when they are asked for.
template <int Dim> class Shares {
public:
  Shares(const Stencil<Dim>& stencil, Exists<Dim> exists, const WindowSites<Dim>& window)
      : stencil_(stencil), exists_(std::move(exists)), whole_(window.sites().eroded(family_reach(stencil))),
        known_(window.lower, window.extent, stencil.reach, std::numeric_limits<double>::quiet_NaN())
  {}
  double of(const Site<Dim>& site)
  {
    if (whole_.has(site)) return 1.0;
    if (!known_.holds(site)) return family_share<Dim>(stencil_, site, exists_);
    double& share = known_[site];
    if (std::isnan(share)) share = family_share<Dim>(stencil_, site, exists_);
    return share;
  }
  double factor(const Site<Dim>& lower, std::size_t arm)
  {
    return 2.0 / (of(lower) + of(shifted<Dim>(lower, stencil_.half[arm].step, 1)));
  }

private:
  const Stencil<Dim>& stencil_;
  Exists<Dim> exists_;
  geom::SiteSet<Dim> whole_; ///< sites of complete families
  SiteMap<Dim, double> known_;
};
} // namespace

template <int Dim> SurfaceCorrection<Dim> correct_volumes(Stencil<Dim> stencil, Exists<Dim> exists)
{
  const auto shared = std::make_shared<const Stencil<Dim>>(std::move(stencil));
  return [shared, exists = std::move(exists)](const WindowSites<Dim>& window) {
    const auto shares = std::make_shared<Shares<Dim>>(*shared, exists, window);
    BondFactors<Dim> factors;
    factors.of = [shared, shares](const Site<Dim>& lower, std::size_t arm) { return shares->factor(lower, arm); };
    const geom::SiteSet<Dim> far = window.sites().eroded(family_reach(*shared) + shared->reach);
    factors.any = [far](const Site<Dim>& lower) { return !far.has(lower); };
    factors.end_of_plain = [far](const Site<Dim>& lower) { return far.has(lower) ? far.end_of_run(lower) : lower[0]; };
    return factors;
  };
}

SurfaceCorrection<2> correct_sides(Stencil<2> stencil, SideWeights weights, Exists<2> exists,
                                   const crack::CrackSet* cracks)
{
  return [stencil = std::move(stencil), weights = std::move(weights), exists = std::move(exists),
          cracks](const WindowSites<2>& window) {
    auto sides = std::make_shared<Sides>(exists, cracks, stencil.reach, window);
    BondFactors<2> factors;
    factors.even_over = 2 * stencil.reach;
    factors.of = [sides, weights, arms = stencil.half](const Site<2>& lower, std::size_t arm) {
      const Site<2>& step = arms[arm].step;
      const Site<2> upper = shifted<2>(lower, step, 1);
      if (!sides->beside(lower) && !sides->beside(upper)) return 1.0;
      const int dx = std::abs(step[0]), dy = step[1];
      const Site<2>&left = step[0] < 0 ? upper : lower, &right = step[0] < 0 ? lower : upper;
      return towards(weights, *sides, 0, lower, upper, dx, dy) * towards(weights, *sides, 1, upper, lower, dx, dy) *
             towards(weights, *sides, 2, left, right, dy, dx) * towards(weights, *sides, 3, right, left, dy, dx);
    };
    factors.any = [sides](const Site<2>& lower) { return sides->bonded(lower); };
    factors.end_of_plain = [sides](const Site<2>& lower) { return sides->end_of_plain(lower); };
    return factors;
  };
}

template int family_reach<2>(const Stencil<2>&);
template int family_reach<3>(const Stencil<3>&);
template double family_share<2>(const Stencil<2>&, const Site<2>&, const Exists<2>&);
template double family_share<3>(const Stencil<3>&, const Site<3>&, const Exists<3>&);
template SurfaceCorrection<2> correct_volumes<2>(Stencil<2>, Exists<2>);
template SurfaceCorrection<3> correct_volumes<3>(Stencil<3>, Exists<3>);
} // namespace pdx::pd
