#include "pdx/geom/box_cover.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::geom {
bool touch(const Box<2>& a, const Box<2>& b, double near)
{
  return (a.lower.array() <= b.upper.array() + near).all() && (b.lower.array() <= a.upper.array() + near).all();
}

bool hold(std::span<const Box<2>> boxes, const Vector<2>& x)
{
  return std::ranges::any_of(boxes, [&x](const Box<2>& box) { return box.contains(x, 1e-6 * box.size().minCoeff()); });
}

Index holder(std::span<const Box<2>> boxes, const Box<2>& box)
{
  const double near = 1e-6 * box.size().minCoeff();
  for (std::size_t k = 0; k < boxes.size(); ++k)
    if (boxes[k].contains(box.lower, near) && boxes[k].contains(box.upper, near)) return static_cast<Index>(k);
  return 0;
}

std::vector<Box<2>> without(const Box<2>& box, const Box<2>& hole, double near)
{
  const Box<2> in{box.lower.cwiseMax(hole.lower), box.upper.cwiseMin(hole.upper)};
  if ((in.size().array() <= near).any()) return {box};
  std::vector<Box<2>> rest{{box.lower, {box.upper[0], in.lower[1]}},
                           {{box.lower[0], in.lower[1]}, {in.lower[0], in.upper[1]}},
                           {{in.upper[0], in.lower[1]}, {box.upper[0], in.upper[1]}},
                           {{box.lower[0], in.upper[1]}, box.upper}};
  std::erase_if(rest, [near](const Box<2>& b) { return (b.size().array() <= near).any(); });
  return rest;
}

namespace {
/// Do they make up one box, side by side along an axis?
bool share_side(const Box<2>& a, const Box<2>& b, double near)
{
  const auto same = [near](double x, double y) { return std::abs(x - y) <= near; };
  for (Eigen::Index d = 0; d < 2; ++d)
    if (same(a.lower[1 - d], b.lower[1 - d]) && same(a.upper[1 - d], b.upper[1 - d]) &&
        (same(a.upper[d], b.lower[d]) || same(b.upper[d], a.lower[d])))
      return true;
  return false;
}
} // namespace

std::vector<Box<2>> joined(std::vector<Box<2>> boxes, double near)
{
  for (std::size_t k = 0; k < boxes.size();) {
    std::size_t other = k + 1;
    while (other < boxes.size() && !share_side(boxes[k], boxes[other], near)) ++other;
    if (other == boxes.size()) {
      ++k;
      continue;
    }
    boxes[k] = {boxes[k].lower.cwiseMin(boxes[other].lower), boxes[k].upper.cwiseMax(boxes[other].upper)};
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(other));
    k = 0; // it may now fit one before
  }
  return boxes;
}
} // namespace pdx::geom
