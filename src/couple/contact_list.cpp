#include "pdx/couple/contact_list.hpp"

#include "pdx/couple/contact_touch.hpp"
#include "pdx/geom/cell_grid.hpp"

#include <cmath>
#include <limits>

namespace pdx::couple {
namespace {
/// Farthest from a facet's nearest corner that a point can be and touch it: a point of a triangle with edges up to e is
/// at most e / sqrt(3) from a corner.
template <int Dim> double reach_of(double size, double others_size)
{
  const double d0 = 0.5 * (size + others_size), edge = ContactSkin<Dim>::kTorn * others_size;
  return std::sqrt(d0 * d0 + edge * edge / (Dim == 2 ? 4.0 : 3.0));
}
} // namespace

template <int Dim>
void ContactList<Dim>::find_boxes(const ContactSkin<Dim>& skin, std::span<const Vector<Dim>> x, std::size_t bodies)
{
  boxes_.assign(bodies, {});
  for (std::size_t p = 0; p < x.size(); ++p) {
    Box& box = boxes_[static_cast<std::size_t>(skin.points()[p].body)];
    box.lower = box.empty ? x[p] : box.lower.cwiseMin(x[p]).eval();
    box.upper = box.empty ? x[p] : box.upper.cwiseMax(x[p]).eval();
    box.empty = false;
  }
}

/// Points within reach of the box of a body they may touch; if there are none, how far all bodies are from that.
template <int Dim>
void ContactList<Dim>::choose(const ContactSkin<Dim>& skin, const ContactLaw<Dim>& law, std::span<const Vector<Dim>> x,
                              double beyond)
{
  chosen_.clear();
  reach_ = 0.0;
  double gap = std::numeric_limits<double>::infinity(); // beyond reach
  struct Partner {
    Index body;
    double reach;
  };
  std::vector<std::vector<Partner>> partners(boxes_.size());
  gaps_.clear();
  for (const auto& pair : law.pairs()) {
    gaps_.push_back(std::numeric_limits<double>::infinity());
    const Box &a = boxes_[static_cast<std::size_t>(pair[0])], &b = boxes_[static_cast<std::size_t>(pair[1])];
    if (a.empty || b.empty) continue;
    const double size_a = skin.sizes(pair[0]).back(), size_b = skin.sizes(pair[1]).back();
    const double reach = std::max(reach_of<Dim>(size_a, size_b), reach_of<Dim>(size_b, size_a));
    const Vector<Dim> apart = (a.lower - b.upper).cwiseMax(b.lower - a.upper).cwiseMax(0.0);
    gaps_.back() = apart.norm();
    gap = std::min(gap, apart.norm() - reach);
    if (!(apart.norm() <= reach + beyond)) continue;
    reach_ = std::max(reach_, reach + beyond);
    partners[static_cast<std::size_t>(pair[0])].push_back({pair[1], reach + beyond});
    partners[static_cast<std::size_t>(pair[1])].push_back({pair[0], reach + beyond});
  }
  slack_ = 0.5 * std::max(gap, beyond);
  for (std::size_t p = 0; p < x.size(); ++p)
    for (const Partner& partner : partners[static_cast<std::size_t>(skin.points()[p].body)]) {
      const Box& box = boxes_[static_cast<std::size_t>(partner.body)];
      const Vector<Dim> apart = (x[p] - box.upper).cwiseMax(box.lower - x[p]).cwiseMax(0.0);
      if (apart.squaredNorm() > partner.reach * partner.reach) continue;
      chosen_.push_back(static_cast<Index>(p));
      break;
    }
}

template <int Dim>
void ContactList<Dim>::renew(const ContactSkin<Dim>& skin, const ContactLaw<Dim>& law, std::span<const Vector<Dim>> x,
                             std::span<const std::uint8_t> mine, double beyond)
{
  near_.clear();
  facets_.clear();
  points_.clear();
  takes_part_.assign(x.size(), 0);
  stamp_.assign(static_cast<std::size_t>(skin.facets()), -1);
  find_boxes(skin, x, law.bodies().size());
  choose(skin, law, x, beyond);
  if (chosen_.empty()) return;
  places_.clear();
  for (const Index p : chosen_) places_.push_back(x[static_cast<std::size_t>(p)]);
  const geom::CellGrid<Dim> grid(places_, reach_);
  std::vector<Index> found;
  for (std::size_t k = 0; k < chosen_.size(); ++k) {
    const Index p = chosen_[k];
    const SkinPoint<Dim>& point = skin.point(p);
    entries_.clear();
    grid.near(places_[k], found);
    for (const Index other : found) {
      const Index q = chosen_[static_cast<std::size_t>(other)];
      const Index body = skin.point(q).body;
      if (!law.may_touch(point.body, body)) continue;
      const double reach = reach_of<Dim>(point.size, skin.sizes(body).back()) + beyond;
      if ((places_[static_cast<std::size_t>(other)] - places_[k]).squaredNorm() > reach * reach) continue;
      for (const Index facet : skin.facets_at(q)) {
        Index& last = stamp_[static_cast<std::size_t>(facet)];
        if (last == p) continue;
        last = p;
        const double d0 = 0.5 * (point.size + skin.facet(facet).size);
        if (distance_to<Dim>(skin.facet(facet), x, places_[k]) <= d0 + beyond) entries_.push_back({body, facet});
      }
    }
    add(skin, p, mine);
  }
  for (std::size_t p = 0; p < takes_part_.size(); ++p)
    if (takes_part_[p]) points_.push_back(static_cast<Index>(p));
}

/// Lists a point before each body that `entries_` has facets of.
template <int Dim>
void ContactList<Dim>::add(const ContactSkin<Dim>& skin, Index point, std::span<const std::uint8_t> mine)
{
  std::ranges::sort(entries_, {}, [](const Entry& e) { return std::pair(e.body, e.facet); });
  for (std::size_t begin = 0, end = 0; begin < entries_.size(); begin = end) {
    while (end < entries_.size() && entries_[end].body == entries_[begin].body) ++end;
    bool moves = mine.empty() || mine[static_cast<std::size_t>(point)];
    for (std::size_t e = begin; e < end && !moves; ++e) {
      const auto& facet = skin.facet(entries_[e].facet);
      for (std::size_t k = 0; k < static_cast<std::size_t>(facet.count); ++k)
        moves = moves || mine[static_cast<std::size_t>(facet.points[k])];
    }
    if (!moves) continue;
    const auto first = static_cast<Index>(facets_.size());
    takes_part_[static_cast<std::size_t>(point)] = 1;
    for (std::size_t e = begin; e < end; ++e) {
      facets_.push_back(entries_[e].facet);
      const auto& facet = skin.facet(entries_[e].facet);
      for (std::size_t k = 0; k < static_cast<std::size_t>(facet.count); ++k)
        takes_part_[static_cast<std::size_t>(facet.points[k])] = 1;
    }
    near_.push_back({point, entries_[begin].body, first, static_cast<Index>(facets_.size())});
  }
}

template <int Dim> void ContactList<Dim>::join(std::span<const Index> points)
{
  for (const Index p : points) {
    if (takes_part_[static_cast<std::size_t>(p)]) continue;
    takes_part_[static_cast<std::size_t>(p)] = 1;
    points_.insert(std::ranges::lower_bound(points_, p), p);
  }
}

template class ContactList<2>;
template class ContactList<3>;
} // namespace pdx::couple
