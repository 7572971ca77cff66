#include "pdx/couple/contact_skin.hpp"

#include "pdx/geom/cell_grid.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::couple {
namespace {
constexpr double kNeighbours = 1.8; // of the mean size: corner to corner of a cube is 1.732
constexpr double kFlat = 0.1;       // of lengths: three points in a line span nothing, lines that cross meet
constexpr double kSameSize = 1e-9;
} // namespace

template <int Dim>
ContactSkin<Dim>::ContactSkin(std::vector<SkinPoint<Dim>> points, Index bodies)
    : points_(std::move(points)), sizes_(static_cast<std::size_t>(bodies))
{
  for (const SkinPoint<Dim>& point : points_) {
    auto& sizes = sizes_[static_cast<std::size_t>(point.body)];
    const auto same = [&](double size) { return std::abs(size - point.size) <= kSameSize * size; };
    if (std::ranges::none_of(sizes, same)) sizes.push_back(point.size);
  }
  for (auto& sizes : sizes_) std::ranges::sort(sizes);
  Neighbours near = neighbours();
  if (Dim == 3) part_crossing(near);
  span_facets(near);
  first_at_.assign(points_.size() + 1, 0);
  for (const Facet& facet : facets_)
    for (int k = 0; k < facet.count; ++k)
      ++first_at_[static_cast<std::size_t>(facet.points[static_cast<std::size_t>(k)]) + 1];
  for (std::size_t p = 0; p < points_.size(); ++p) first_at_[p + 1] += first_at_[p];
  at_.resize(first_at_.back());
  std::vector<std::size_t> next = first_at_;
  for (std::size_t f = 0; f < facets_.size(); ++f)
    for (int k = 0; k < facets_[f].count; ++k)
      at_[next[static_cast<std::size_t>(facets_[f].points[static_cast<std::size_t>(k)])]++] = static_cast<Index>(f);
}

template <int Dim> std::span<const Index> ContactSkin<Dim>::facets_at(Index point) const
{
  const auto p = static_cast<std::size_t>(point);
  return {at_.data() + first_at_[p], first_at_[p + 1] - first_at_[p]};
}

template <int Dim> typename ContactSkin<Dim>::Neighbours ContactSkin<Dim>::neighbours() const
{
  Neighbours all(points_.size());
  if (points_.empty()) return all;
  std::vector<Vector<Dim>> places;
  double largest = 0.0;
  for (const SkinPoint<Dim>& point : points_) {
    places.push_back(point.place);
    largest = std::max(largest, point.size);
  }
  const geom::CellGrid<Dim> grid(places, kNeighbours * largest);
  std::vector<Index> near;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    grid.near(places[p], near);
    for (const Index q : near) {
      const SkinPoint<Dim>& other = point(q);
      const double reach = kNeighbours * 0.5 * (points_[p].size + other.size);
      if (q != static_cast<Index>(p) && other.body == points_[p].body &&
          (other.place - places[p]).squaredNorm() <= reach * reach)
        all[p].push_back(q);
    }
  }
  return all;
}

/// Of two diagonals of one square: does that from p to q make way for that from r to s? The longer does, or that
/// without the first point: a square is two triangles, not four that take turns.
template <int Dim> bool ContactSkin<Dim>::gives_way(Index p, Index q, Index r, Index s) const
{
  const Vector<Dim> pq = point(q).place - point(p).place, rs = point(s).place - point(r).place,
                    between = point(r).place - point(p).place;
  const double a = pq.squaredNorm(), b = pq.dot(rs), c = rs.squaredNorm(), area2 = a * c - b * b;
  if (area2 < kFlat * kFlat * a * c) return false;
  const double on_pq = (c * pq.dot(between) - b * rs.dot(between)) / area2,
               on_rs = (b * pq.dot(between) - a * rs.dot(between)) / area2;
  const auto inside = [](double share) { return share > kFlat && share < 1.0 - kFlat; };
  if (!inside(on_pq) || !inside(on_rs) || (between + on_rs * rs - on_pq * pq).squaredNorm() > kFlat * kFlat * a)
    return false;
  return std::abs(a - c) > kSameSize * a ? a > c : std::min(p, q) > std::min(r, s);
}

template <int Dim> void ContactSkin<Dim>::part_crossing(Neighbours& near) const
{
  const Neighbours all = near;
  const auto at = [&all](Index p) -> const std::vector<Index>& { return all[static_cast<std::size_t>(p)]; };
  std::vector<Index> common;
  for (Index p = 0; p < static_cast<Index>(points_.size()); ++p)
    std::erase_if(near[static_cast<std::size_t>(p)], [&](Index q) {
      common.clear();
      std::ranges::set_intersection(at(p), at(q), std::back_inserter(common));
      for (const Index r : common)
        for (const Index s : common)
          if (r < s && std::ranges::binary_search(at(r), s) && gives_way(p, q, r, s)) return true;
      return false;
    });
}

template <int Dim> void ContactSkin<Dim>::add_facet(std::span<const Index> points)
{
  Facet facet;
  for (const Index p : points) {
    facet.points[static_cast<std::size_t>(facet.count++)] = p;
    facet.size += point(p).size / static_cast<double>(points.size());
  }
  facets_.push_back(facet);
}

template <int Dim> bool ContactSkin<Dim>::is_flat(Index p, Index q, Index r) const
{
  const Vector<Dim> a = point(q).place - point(p).place, b = point(r).place - point(p).place;
  const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
  return a.squaredNorm() * b.squaredNorm() - a.dot(b) * a.dot(b) < kFlat * kFlat * longest2 * longest2;
}

/// Triangles of three neighbours, segments where there are none (always in the plane), points without a neighbour.
template <int Dim> void ContactSkin<Dim>::span_facets(const Neighbours& near)
{
  std::vector<Index> common;
  for (Index p = 0; p < static_cast<Index>(points_.size()); ++p) {
    const auto& of_p = near[static_cast<std::size_t>(p)];
    if (of_p.empty()) add_facet(std::array{p});
    for (const Index q : of_p) {
      if (q < p) continue;
      bool alone = true;
      if constexpr (Dim == 3) {
        common.clear();
        std::ranges::set_intersection(of_p, near[static_cast<std::size_t>(q)], std::back_inserter(common));
        for (const Index r : common) {
          if (is_flat(p, q, r)) continue;
          alone = false;
          if (r > q) add_facet(std::array{p, q, r});
        }
      }
      if (alone) add_facet(std::array{p, q});
    }
  }
}

template class ContactSkin<2>;
template class ContactSkin<3>;
} // namespace pdx::couple
