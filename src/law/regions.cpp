#include "pdx/law/regions.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::law {
bool same(const Elastic& a, const Elastic& b)
{
  return a.young == b.young && a.poisson == b.poisson && a.plane == b.plane && a.thickness == b.thickness &&
         a.density == b.density;
}

Regions::Regions(const Elastic& rest, double toughness, double reference, std::vector<Region> regions,
                 std::span<const Interface> interfaces)
    : rest_(rest), regions_(std::move(regions))
{
  std::vector<double> gc(count() * count());
  const auto thick = [this](std::size_t region) { return elastic(region).thickness / rest_.thickness; };
  const auto own = [&](std::size_t region) {
    return (region ? regions_[region - 1].toughness : toughness) * thick(region);
  };
  for (std::size_t a = 0; a < count(); ++a) {
    one_elastic_ = one_elastic_ && same(elastic(a), rest_);
    for (std::size_t b = 0; b < count(); ++b) {
      const auto stiff = [this](std::size_t region) {
        return elastic(region).young * elastic(region).thickness / (rest_.young * rest_.thickness);
      };
      const double ra = stiff(a), rb = stiff(b);
      stiffness_.push_back(2.0 * ra * rb / (ra + rb));
      gc[a * count() + b] = std::min(own(a), own(b));
    }
  }
  for (std::size_t a = 0; a < count(); ++a) // what never breaks holds its neighbours' bonds too
    for (std::size_t b = 0; b < count(); ++b)
      if (std::isinf(own(a)) || std::isinf(own(b))) gc[a * count() + b] = std::max(own(a), own(b));
  for (const Interface& i : interfaces)
    gc[i.a * count() + i.b] = gc[i.b * count() + i.a] = i.toughness * std::min(thick(i.a), thick(i.b));
  for (std::size_t k = 0; k < gc.size(); ++k) {
    stretch_.push_back(std::sqrt(gc[k] / reference / stiffness_[k]));
    one_stretch_ = one_stretch_ && stretch_.back() == 1.0;
  }
  least_stretch_ = *std::ranges::min_element(stretch_);
}

std::uint8_t Regions::at(const Vector<2>& x) const
{
  for (std::size_t k = regions_.size(); k-- > 0;)
    if (regions_[k].outline.holds(x)) return static_cast<std::uint8_t>(k + 1);
  return 0;
}
} // namespace pdx::law
