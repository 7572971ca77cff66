#include "pdx/pd/surface.hpp"

#include "free_sides.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

namespace pdx::pd {
using namespace free_sides;
namespace {
/// Of the bond from one site to another, which spans `step`, by the sides across one axis.
template <int Dim, class Weights>
double across(const Weights& weights, const Sides<Dim>& sides, const Site<Dim>& lower, const Site<Dim>& upper,
              const Site<Dim>& step, std::size_t axis)
{
  const Site<Dim>&low = step[axis] < 0 ? upper : lower, &high = step[axis] < 0 ? lower : upper;
  const int below = sides.rows(low, 2 * axis), above = sides.rows(high, 2 * axis + 1);
  if constexpr (Dim == 3)
    if (const int layers = sides.rows_across(below < weights.rows() ? low : high, axis)) {
      const int row = std::min(below, above);
      if (const auto both = weights.between(layers, row, step, axis)) return *both;
    }
  if (step[axis]) return weights.at(below, step, axis) * weights.at(above, step, axis);
  // Ends in one row see the same side, unless it ends between them.
  return 0.5 * (weights.at(below, step, axis) + weights.at(sides.rows(high, 2 * axis), step, axis)) * 0.5 *
         (weights.at(sides.rows(low, 2 * axis + 1), step, axis) + weights.at(above, step, axis));
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

namespace {
template <int Dim, class Weights>
SurfaceCorrection<Dim> correct_by(Stencil<Dim> stencil, Weights weights, int sight, Exists<Dim> exists,
                                  const crack::CrackSet* cracks)
{
  return [stencil = std::move(stencil), weights = std::move(weights), sight, exists = std::move(exists),
          cracks](const WindowSites<Dim>& window) {
    auto sides = std::make_shared<Sides<Dim>>(exists, cracks, stencil.reach, sight, window);
    BondFactors<Dim> factors;
    factors.even_over = 2 * stencil.reach;
    factors.of = [sides, weights, arms = stencil.half](const Site<Dim>& lower, std::size_t arm) {
      const Site<Dim>& step = arms[arm].step;
      const Site<Dim> upper = shifted<Dim>(lower, step, 1);
      double factor = 1.0;
      if (!sides->beside(lower) && !sides->beside(upper)) return factor;
      for (std::size_t axis = Dim; axis-- > 0;) factor *= across<Dim>(weights, *sides, lower, upper, step, axis);
      return factor;
    };
    factors.any = [sides](const Site<Dim>& lower) { return sides->bonded(lower); };
    factors.end_of_plain = [sides](const Site<Dim>& lower) { return sides->end_of_plain(lower); };
    return factors;
  };
}
} // namespace

SurfaceCorrection<2> correct_sides(Stencil<2> stencil, SideWeights weights, Exists<2> exists,
                                   const crack::CrackSet* cracks)
{
  const int sight = stencil.reach;
  return correct_by<2>(std::move(stencil), std::move(weights), sight, std::move(exists), cracks);
}

SurfaceCorrection<3> correct_sides(Stencil<3> stencil, SolidSides weights, Exists<3> exists,
                                   const crack::CrackSet* cracks)
{
  const int sight = weights.thick() - 1;
  return correct_by<3>(std::move(stencil), std::move(weights), sight, std::move(exists), cracks);
}

template int family_reach<2>(const Stencil<2>&);
template int family_reach<3>(const Stencil<3>&);
template double family_share<2>(const Stencil<2>&, const Site<2>&, const Exists<2>&);
template double family_share<3>(const Stencil<3>&, const Site<3>&, const Exists<3>&);
template SurfaceCorrection<2> correct_volumes<2>(Stencil<2>, Exists<2>);
template SurfaceCorrection<3> correct_volumes<3>(Stencil<3>, Exists<3>);
} // namespace pdx::pd
