#include "pdx/couple/contact_start.hpp"

#include "pdx/base/error.hpp"
#include "pdx/couple/contact_list.hpp"
#include "pdx/couple/contact_touch.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pdx::couple {
namespace {
/// The two points of different bodies that are nearest to each other, of those nearer than d0 by the largest share.
struct Overlap {
  Index a = -1, b = -1;
  double distance = 0.0, share = 1.0 - kTouching; ///< of d0
};

template <int Dim>
void find_overlap(const ContactSkin<Dim>& skin, std::span<const Index> facets, Index point, Overlap& worst)
{
  const SkinPoint<Dim>& here = skin.point(point);
  for (const Index number : facets)
    for (std::size_t k = 0; k < static_cast<std::size_t>(skin.facet(number).count); ++k) {
      const Index other = skin.facet(number).points[k];
      const SkinPoint<Dim>& there = skin.point(other);
      const double distance = (there.place - here.place).norm(), share = distance / (0.5 * (here.size + there.size));
      if (share < worst.share) worst = {point, other, distance, share};
    }
}

template <int Dim> void refuse(const ContactSkin<Dim>& skin, const ContactLaw<Dim>& law, const Overlap& overlap)
{
  const SkinPoint<Dim>&a = skin.point(overlap.a), &b = skin.point(overlap.b);
  const Vector<Dim> x = law.options().frame.given(a.place), y = law.options().frame.given(b.place);
  const auto name = [&](const SkinPoint<Dim>& p) { return law.bodies()[static_cast<std::size_t>(p.body)].name; };
  throw UserError(fmt::format("bodies {} and {} overlap at the start: points at ({:g}) and ({:g}) are {:.6g} m apart, "
                              "and need {:.6g} m; move the bodies apart",
                              name(a), name(b), fmt::join(x.data(), x.data() + Dim, ", "),
                              fmt::join(y.data(), y.data() + Dim, ", "), overlap.distance, 0.5 * (a.size + b.size)));
}
} // namespace

template <int Dim> std::vector<StartOffset> start_offsets(const ContactSkin<Dim>& skin, const ContactLaw<Dim>& law)
{
  std::vector<Vector<Dim>> places;
  for (const SkinPoint<Dim>& point : skin.points()) places.push_back(point.place);
  ContactList<Dim> list;
  list.renew(skin, law, places, {}, 0.0);
  Overlap worst;
  std::vector<StartOffset> offsets;
  for (const auto& near : list.near()) {
    find_overlap(skin, list.facets(near), near.point, worst);
    const Touch<Dim> touch = deepest_touch<Dim>(skin, list.facets(near), places, near.point);
    if (touch.facet >= 0) offsets.push_back({near.point, near.body, touch.overlap});
  }
  if (worst.a >= 0) refuse(skin, law, worst);
  return offsets;
}

template std::vector<StartOffset> start_offsets<2>(const ContactSkin<2>&, const ContactLaw<2>&);
template std::vector<StartOffset> start_offsets<3>(const ContactSkin<3>&, const ContactLaw<3>&);
} // namespace pdx::couple
