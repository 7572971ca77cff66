#include "pdx/pd/region_factors.hpp"

#include <algorithm>

namespace pdx::pd {
namespace region_factors {
/// The regions of the sites of a window and of those that bonds from it reach.
template <int Dim> class RegionMap {
public:
  RegionMap(const Stencil<Dim>& stencil, const law::Regions& regions, const WindowSites<Dim>& window)
      : stencil_(stencil), regions_(regions)
  {
    std::size_t size = 1;
    for (std::size_t d = 0; d < Dim; ++d) {
      lower_[d] = window.lower[d] - stencil.reach;
      extent_[d] = window.extent[d] > 0 ? window.extent[d] + 2 * stencil.reach : 0;
      size *= static_cast<std::size_t>(extent_[d]);
    }
    region_.resize(size);
    Site<Dim> site = lower_;
    for (std::uint8_t& region : region_) {
      region = regions.at(window.lattice.point(site).template head<2>());
      for (std::size_t d = 0; d < Dim; ++d) {
        if (++site[d] < lower_[d] + extent_[d]) break;
        site[d] = lower_[d];
      }
    }
  }

  double factor(const Site<Dim>& lower, std::size_t arm) const
  {
    Site<Dim> upper = lower;
    for (std::size_t d = 0; d < Dim; ++d) upper[d] += stencil_.half[arm].step[d];
    return regions_.stiffness(at(lower), at(upper));
  }
  /// Has any bond that starts there another stiffness than one in region 0?
  bool any(const Site<Dim>& lower) const
  {
    for (std::size_t arm = 0; arm < stencil_.half.size(); ++arm)
      if (factor(lower, arm) != 1.0) return true;
    return false;
  }
  /// x after the sites of the window along x, from this one on, that have none such.
  Index end_of_plain(Site<Dim> site) const
  {
    const Index end = lower_[0] + extent_[0] - stencil_.reach;
    while (site[0] < end && !any(site)) ++site[0];
    return site[0];
  }

private:
  std::uint8_t at(const Site<Dim>& site) const
  {
    std::size_t place = 0;
    for (std::size_t d = Dim; d-- > 0;) {
      const Index x = std::clamp(site[d] - lower_[d], 0, extent_[d] - 1);
      place = place * static_cast<std::size_t>(extent_[d]) + static_cast<std::size_t>(x);
    }
    return region_[place];
  }

  const Stencil<Dim>& stencil_;
  const law::Regions& regions_;
  Site<Dim> lower_{}, extent_{};
  std::vector<std::uint8_t> region_;
};
} // namespace region_factors

template <int Dim>
SurfaceCorrection<Dim> correct_regions(Stencil<Dim> stencil, std::shared_ptr<const law::Regions> regions,
                                       SurfaceCorrection<Dim> surfaces)
{
  const auto shared = std::make_shared<const Stencil<Dim>>(std::move(stencil));
  return [shared, regions = std::move(regions), surfaces = std::move(surfaces)](const WindowSites<Dim>& window) {
    const auto map = std::make_shared<const region_factors::RegionMap<Dim>>(*shared, *regions, window);
    BondFactors<Dim> at_surfaces;
    if (surfaces) at_surfaces = surfaces(window);
    BondFactors<Dim> factors;
    factors.even_over = at_surfaces.even_over;
    factors.surface = [at_surfaces](const Site<Dim>& lower, std::size_t arm) {
      return at_surfaces.of && at_surfaces.any(lower) ? at_surfaces.of(lower, arm) : 1.0;
    };
    factors.of = [shared, regions, map, surface = factors.surface](const Site<Dim>& lower, std::size_t arm) {
      return surface(lower, arm) * map->factor(lower, arm);
    };
    factors.any = [shared, regions, map, at_surfaces](const Site<Dim>& lower) {
      return (at_surfaces.any && at_surfaces.any(lower)) || map->any(lower);
    };
    factors.end_of_plain = [shared, regions, map, at_surfaces](const Site<Dim>& lower) {
      const Index end = map->end_of_plain(lower);
      return at_surfaces.end_of_plain ? std::min(end, at_surfaces.end_of_plain(lower)) : end;
    };
    return factors;
  };
}

template SurfaceCorrection<2> correct_regions<2>(Stencil<2>, std::shared_ptr<const law::Regions>, SurfaceCorrection<2>);
template SurfaceCorrection<3> correct_regions<3>(Stencil<3>, std::shared_ptr<const law::Regions>, SurfaceCorrection<3>);
} // namespace pdx::pd
