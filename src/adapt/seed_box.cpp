#include "pdx/adapt/seed_box.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

namespace pdx::adapt {
namespace {
/// A box of whole elements, counted in spacings and in [m].
struct Block {
  std::array<std::int64_t, 2> from, to;
  geom::Box<2> box;
  std::int64_t sites() const { return (to[0] - from[0]) * (to[1] - from[1]); }
};

Block block_of(const geom::Box<2>& box, const geom::Lattice<2>& lattice)
{
  Block block{{}, {}, box};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto e = static_cast<Eigen::Index>(d);
    block.from[d] = static_cast<std::int64_t>(std::round((box.lower[e] - lattice.origin[e]) / lattice.dx));
    block.to[d] = static_cast<std::int64_t>(std::round((box.upper[e] - lattice.origin[e]) / lattice.dx));
  }
  return block;
}

geom::Box<2> box_around_all(std::span<const Corners> elements)
{
  geom::Box<2> all = box_around(elements[0]);
  for (const Corners& element : elements) {
    const geom::Box<2> box = box_around(element);
    all = {all.lower.cwiseMin(box.lower), all.upper.cwiseMax(box.upper)};
  }
  return all;
}

/// A box of whole elements that takes in layers of others.
class Growth {
public:
  Growth(Block first, const geom::Lattice<2>& lattice) : now_(std::move(first)), lattice_(lattice) {}

  void offer(const Corners& element, bool wanted)
  {
    if (!is_divided(element, lattice_)) return;
    const Block block = block_of(box_around(element), lattice_);
    for (std::size_t d = 0; d < 2; ++d) {
      above_[d][block.from[d]].push_back({block, wanted});
      below_[d][block.to[d]].push_back({block, wanted});
    }
  }
  /// Takes in a layer on either side, where one is whole and wanted.
  bool grow(std::size_t axis)
  {
    const std::optional<Block> up = layer(axis, above_[axis], now_.to[axis]);
    const std::optional<Block> down = layer(axis, below_[axis], now_.from[axis]);
    const auto e = static_cast<Eigen::Index>(axis);
    if (up) {
      now_.to[axis] = up->to[axis];
      now_.box.upper[e] = up->box.upper[e];
    }
    if (down) {
      now_.from[axis] = down->from[axis];
      now_.box.lower[e] = down->box.lower[e];
    }
    return up || down;
  }
  const geom::Box<2>& box() const { return now_.box; }

private:
  struct Offer {
    Block block;
    bool wanted;
  };
  using Offers = std::map<std::int64_t, std::vector<Offer>>; // by the line on which they begin

  std::optional<Block> layer(std::size_t axis, const Offers& offers, std::int64_t line) const
  {
    const auto found = offers.find(line);
    if (found == offers.end()) return std::nullopt;
    const std::size_t across = 1 - axis;
    std::optional<Block> first;
    std::int64_t filled = 0;
    bool wanted = false;
    for (const auto& [block, is_wanted] : found->second) {
      if (block.from[across] < now_.from[across] || block.to[across] > now_.to[across]) continue;
      if (first && (block.from[axis] != first->from[axis] || block.to[axis] != first->to[axis])) return std::nullopt;
      if (!first) first = block;
      filled += block.to[across] - block.from[across];
      wanted = wanted || is_wanted;
    }
    return wanted && filled == now_.to[across] - now_.from[across] ? first : std::nullopt;
  }

  Block now_;
  geom::Lattice<2> lattice_;
  std::array<Offers, 2> above_, below_; // per axis
};
} // namespace

double share_of_turn(const Corners& element, const Vector<2>& x, double near)
{
  const auto cross = [](const Vector<2>& a, const Vector<2>& b) { return a[0] * b[1] - a[1] * b[0]; };
  double nearest = std::numeric_limits<double>::infinity(); // edge, from inside [m]
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector<2> next = element[(k + 1) % 4] - element[k], last = element[(k + 3) % 4] - element[k];
    if ((x - element[k]).norm() <= near)
      return std::atan2(cross(next, last), next.dot(last)) / (2.0 * std::numbers::pi);
    nearest = std::min(nearest, cross(next, x - element[k]) / next.norm());
  }
  return nearest < -near ? 0.0 : nearest <= near ? 0.5 : 1.0;
}

std::optional<geom::Box<2>> seed_box(std::span<const Corners> own, std::span<const Corners> around,
                                     const Vector<2>& tip, double spacing, double reach)
{
  if (own.empty()) return std::nullopt;
  const geom::Box<2> first = box_around_all(own);
  geom::Lattice<2> lattice;
  lattice.origin = first.lower;
  lattice.dx = spacing;
  const Block block = block_of(first, lattice);
  std::int64_t filled = 0;
  for (const Corners& element : own) {
    if (!is_divided(element, lattice)) return std::nullopt;
    filled += block_of(box_around(element), lattice).sites();
  }
  if (filled != block.sites()) return std::nullopt;
  Growth growth(block, lattice);
  const double far = (1.0 - kSame) * reach;
  for (const Corners& element : around)
    growth.offer(element, std::ranges::any_of(element, [&](const Vector<2>& x) { return (x - tip).norm() < far; }));
  for (bool grown = true; grown;) {
    grown = growth.grow(0);
    grown = growth.grow(1) || grown;
  }
  return growth.box();
}
} // namespace pdx::adapt
